// Several maps a point: slow even where it is given one.
layout(points, max_vertices = 16) out;
