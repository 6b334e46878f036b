// Up to 16 maps a point: slow even if only one is drawn.
layout(points, max_vertices = 16) out;
