// Marks the depth slices of a tile that a triangle of a VPL's hull may pass through.
#include "gather/shell-triangle.glsl"

layout(constant_id = 1) const bool GLOSSY = false; // whether the hulls are of glossy VPLs

layout(scalar) buffer DiffuseShells { uvec2 at[]; } diffuse_shells; // by VPL and tile of its set: slices of near and of far sides
layout(scalar) buffer GlossyShells { uvec2 at[]; } glossy_shells;

bool in_set(uvec2 tile, uint vpl) { return all(equal(tile / sorted_tiles(), set_of(vpl))); }

// `vpl`: its number, and 1 if the triangle is on the far side.
void mark(uvec2 tile, vec3 plane, vec2 range, uvec2 vpl) {
    if (any(notEqual(plane, vec3(0.0)))) {
        float middle = dot(plane, vec3(vec2(tile) + 0.5, 1.0)), half_span = 0.501 * (abs(plane.x) + abs(plane.y));
        range = vec2(max(range.x, middle - half_span), min(range.y, middle + half_span));
    }
    // Margins against rounding, which is far smaller.
    uint first = shell_slice(0.9999 / max(range.y, 1e-20), view.it.diagonal), last = shell_slice(1.0001 / max(range.x, 1e-20), view.it.diagonal);
    if (first > last) return;
    uint bits = (0xffffffffu << first) & (0xffffffffu >> (31u - last));
    uvec2 tiles = sorted_tiles();
    tile -= set_of(vpl.x) * tiles;
    uint at = vpl.x * tiles.x * tiles.y + tile.y * tiles.x + tile.x;
    if (GLOSSY) {
        if (vpl.y == 0u) atomicOr(glossy_shells.at[at].x, bits);
        else atomicOr(glossy_shells.at[at].y, bits);
    } else {
        if (vpl.y == 0u) atomicOr(diffuse_shells.at[at].x, bits);
        else atomicOr(diffuse_shells.at[at].y, bits);
    }
}
