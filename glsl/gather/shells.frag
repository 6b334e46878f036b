#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Discards tiles of a triangle's bounding rectangle that it does not touch.
#include "gather/shell.glsl"
#include "gather/shell-mark.glsl"

layout(location = 0) flat in vec3 in_edges[4];
layout(location = 4) flat in vec3 in_plane;
layout(location = 5) flat in vec2 in_range;
layout(location = 6) flat in uvec2 in_vpl;

layout(location = 0) out float touched;

void main() {
    touched = 1.0;
    uvec2 tile = uvec2(gl_FragCoord.xy);
    if (!in_set(tile, in_vpl.x)) return;
    vec3 place = vec3(vec2(tile) + 0.5, 1.0);
    for (int i = 0; i < 4; i++) {
        // Tested at the tile's corner that is farthest inside the edge.
        if (dot(in_edges[i], place) + 0.501 * (abs(in_edges[i].x) + abs(in_edges[i].y)) < 0.0) return;
    }
    mark(tile, in_plane, in_range, in_vpl);
}
