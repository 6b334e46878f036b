#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Hull of a VPL's range, for conservative rasterization by the device. Each vertex computes its whole triangle.
#include "gather/bounds.glsl"
#include "gather/shell.glsl"
#include "gather/shell-triangle.glsl"

layout(scalar) readonly buffer Corners { vec3 at[]; } corners; // corners of triangles around the unit sphere

layout(location = 0) flat out vec3 out_plane; // as in ShellTriangle
layout(location = 1) flat out vec2 out_range;
layout(location = 2) flat out uvec2 out_vpl;  // VPL, and whether the triangle is on the far side

out gl_PerVertex {
    vec4 gl_Position;
    float gl_ClipDistance[4];
};

void main() {
    uint index = gl_InstanceIndex, vertex = gl_VertexIndex, corner = vertex % 3u, first = vertex - corner;
    // In front of the near plane, so that an empty hull is clipped.
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    gl_ClipDistance[0] = gl_ClipDistance[1] = gl_ClipDistance[2] = gl_ClipDistance[3] = -1.0;
    out_plane = vec3(0.0);
    out_range = vec2(0.0);
    out_vpl = uvec2(index, 0u);
    vec3 points[3], centre;
    for (uint i = 0u; i < 3u; i++) {
        if (!on_bounds(index, corners.at[first + i], points[i], centre)) return;
    }
    uvec2 set = set_of(index), tiles = sorted_tiles();
    ShellTriangle triangle = shell_triangle(points[0], points[1], points[2], centre, set);
    out_plane = triangle.plane;
    out_range = triangle.range;
    out_vpl.y = uint(triangle.behind);
    // In tiles of the set's picture, times the distance; the picture's sides clip the triangle.
    vec3 point = points[corner];
    vec2 place = sorted_place(point, set) / float(SHELL_TILE), rest = vec2(tiles) * point.z - place;
    gl_ClipDistance[0] = place.x;
    gl_ClipDistance[1] = place.y;
    gl_ClipDistance[2] = rest.x;
    gl_ClipDistance[3] = rest.y;
    gl_Position = vec4((place + vec2(set * tiles) * point.z) / vec2(tiles * block_size()) * 2.0 - point.z, view.it.near, point.z);
}
