#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Uniform sampling of all maps' texels (Barak et al.): Halton points over light, column and row. The bases are odd, so that every sample
// set of an interleaved gather, whose size is a power of two, covers everything.
#include "lib/halton.glsl"
#include "vpls/texel.glsl"

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    // Point 0 is a corner and is skipped.
    vec3 u = vec3(radical_inverse(index + 1u, 3u), radical_inverse(index + 1u, 5u), radical_inverse(index + 1u, 7u));
    uint layer = min(uint(u.x * float(params.lights)), params.lights - 1u);
    ivec2 texel = min(ivec2(u.yz * vec2(params.size)), ivec2(params.size) - 1);
    put(index, ivec3(texel, layer), float(params.lights) * float(params.size.x) * float(params.size.y) / float(params.count));
}
