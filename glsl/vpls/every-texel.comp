#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// A VPL from every texel of the reflective shadow maps (Tokuyoshi and Harada 2017, section 7), in the order of a fixed permutation.
#include "vpls/texel.glsl"

void main() {
    // Texels are read in order and VPLs written in permuted order: reading six maps at random misses caches more than writing VPLs at
    // random.
    uint sample_index = gl_GlobalInvocationID.x;
    if (sample_index >= params.count) return;
    uint k, count, layer;
    map_of(sample_index, layer, k, count);
    put(permutation_inverse(sample_index, params.count), ivec3(k % params.size.x, k / params.size.x, layer), 1.0);
}
