// A map a point. Each part for "most" says how many the stage gives at most.
layout(points, max_vertices = 1) out;
