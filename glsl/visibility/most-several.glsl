// Several maps a point; slow even if one is all that it gets.
layout(points, max_vertices = 16) out;
