// Every texel of the reflective shadow maps (Tokuyoshi and Harada 2017, section 7), in the order of a fixed permutation.
#include "vpls/texel.glsl"

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    uint k, count, layer;
    share_of(index, layer, k, count);
    put(index, ivec3(k % params.size.x, k / params.size.x, layer), 1.0);
}
