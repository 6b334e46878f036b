// Corner of a small triangle. Clockwise in the tessellator's coordinates, whose origin is above, is counter-clockwise here: normals point
// to the front.
layout(triangles, equal_spacing, cw) in;

layout(location = 0) in vec3 position[];
layout(location = 1) patch in uvec4 triangle;
layout(location = 2) patch in uvec2 part;

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_place; // barycentric
layout(location = 2) flat out uvec4 out_triangle;
layout(location = 3) flat out uvec2 out_part;

void main() {
    out_position = mat3(position[0], position[1], position[2]) * gl_TessCoord;
    out_place = gl_TessCoord;
    out_triangle = triangle;
    out_part = part;
}
