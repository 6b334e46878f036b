#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Marks the slices of a tile through which a triangle of a VPL's bounds may run.
#include "gather/shell.glsl"
#include "gather/shell-cluster.glsl"

layout(location = 0) flat in vec3 in_edges[4];
layout(location = 4) flat in vec3 in_plane;
layout(location = 5) flat in vec2 in_range;
layout(location = 6) flat in uvec2 in_vpl;

layout(location = 0) out float touched;

layout(scalar) buffer DiffuseShells { uvec2 at[]; } diffuse_shells; // of a VPL and a tile of its set: slices of near and of far sides
layout(scalar) buffer GlossyShells { uvec2 at[]; } glossy_shells;

void main() {
    touched = 1.0;
    vec3 place = vec3(floor(gl_FragCoord.xy) + 0.5, 1.0);
    uvec2 tiles = (sorted_size() + SHELL_TILE - 1u) / SHELL_TILE, tile = uvec2(gl_FragCoord.xy), set = set_of(in_vpl.x);
    if (any(notEqual(tile / tiles, set))) return;
    for (int i = 0; i < 4; i++) {
        // The tile's corner that is farthest inside.
        if (dot(in_edges[i], place) + 0.501 * (abs(in_edges[i].x) + abs(in_edges[i].y)) < 0.0) return;
    }
    vec2 range = in_range;
    if (any(notEqual(in_plane, vec3(0.0)))) {
        float middle = dot(in_plane, place), half_span = 0.501 * (abs(in_plane.x) + abs(in_plane.y));
        range = vec2(max(range.x, middle - half_span), min(range.y, middle + half_span));
    }
    // Rounding may move both ends; by far less than this.
    uint first = shell_slice(0.9999 / max(range.y, 1e-20), view.it.diagonal), last = shell_slice(1.0001 / max(range.x, 1e-20), view.it.diagonal);
    if (first > last) return;
    uint bits = (0xffffffffu << first) & (0xffffffffu >> (31u - last));
    tile -= set * tiles;
    uint at = in_vpl.x * tiles.x * tiles.y + tile.y * tiles.x + tile.x;
    if (GLOSSY) {
        if (in_vpl.y == 0u) atomicOr(glossy_shells.at[at].x, bits);
        else atomicOr(glossy_shells.at[at].y, bits);
    } else {
        if (in_vpl.y == 0u) atomicOr(diffuse_shells.at[at].x, bits);
        else atomicOr(diffuse_shells.at[at].y, bits);
    }
}
