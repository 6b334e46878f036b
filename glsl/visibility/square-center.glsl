// Splats as deep as their middle. Each part for "square" declares the outputs of a splat's vertex, and writes them.
layout(location = 0) flat out ivec2 corner;

void put_plane(Square square) {}
