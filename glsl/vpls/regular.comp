#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Regular samples of the reflective shadow maps, in the order of a fixed permutation (Linke 2016, sections 4.3 and 4.5).
#include "vpls/grid.glsl"
#include "vpls/texel.glsl"

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    uint k, count, layer;
    share_of(index, layer, k, count);
    // Each sample represents its own share of the map's texels.
    uvec2 at, grid;
    grid_sample(k, count, params.size, at, grid);
    // Texel at the centre of the sample's share, in whole numbers, so that every device takes the same. A seed moves the pattern by less
    // than a share; rounded once, so that all texels are as likely.
    uvec2 texel = (2u * at + 1u) * params.size / (2u * grid);
    if (any(greaterThan(params.shift.xy, vec2(0.0)))) texel = uvec2((vec2(at) + 0.5 + params.shift.xy) * vec2(params.size) / vec2(grid));
    put(index, ivec3(texel % params.size, layer), float(params.size.x) / float(grid.x) * (float(params.size.y) / float(grid.y)));
}
