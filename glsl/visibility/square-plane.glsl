// Splats as deep as the plane of their point.
layout(location = 0) flat out ivec2 corner;
layout(location = 1) flat out vec4 plane;
layout(location = 2) flat out float nearest;

void put_plane(Square square) {
    plane = square.plane;
    nearest = square.nearest;
}
