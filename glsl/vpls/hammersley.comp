#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Hammersley samples of the reflective shadow maps (Aranha et al., section III-A), in the order of a fixed permutation.
#include "lib/hammersley.glsl"
#include "vpls/texel.glsl"

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    uint k, count, layer;
    share_of(index, layer, k, count);
    ivec2 texel = min(ivec2(fract(hammersley(k, count) + params.shift.xy) * vec2(params.size)), ivec2(params.size) - 1);
    put(index, ivec3(texel, layer), float(params.size.x) * float(params.size.y) / float(count));
}
