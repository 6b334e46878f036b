// One map a point. Each part for "most" declares the geometry stage's output.
layout(points, max_vertices = 1) out;
