#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Regular samples of the reflective shadow maps, in the order of a fixed permutation (Linke 2016, sections 4.3 and 4.5).
#include "vpls/texel.glsl"

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    uint k, count, layer;
    share_of(index, layer, k, count);

    // Rows of samples with a spacing as nearly square as whole numbers allow. Rows differ by at most one sample, and each sample represents
    // its own share of the map's texels.
    uint rows = clamp(uint(round(sqrt(float(count) * float(params.size.y) / float(params.size.x)))), 1u, min(count, params.size.y));
    uint in_row = count / rows, longer = count % rows;
    uint in_longer = (in_row + 1u) * longer;
    uint row = k < in_longer ? k / (in_row + 1u) : longer + (k - in_longer) / in_row;
    uint columns = in_row + uint(row < longer);
    uint column = k - (row * in_row + min(row, longer));
    // Texel at the centre of the sample's share, in whole numbers, so that every device takes the same.
    ivec2 texel = ivec2((2u * uvec2(column, row) + 1u) * params.size / (2u * uvec2(columns, rows)));
    put(index, ivec3(texel, layer), float(params.size.x) / float(columns) * (float(params.size.y) / float(rows)));
}
