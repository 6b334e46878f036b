#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Floor of the view's importance, from 64 x AT_ONCE = 1,024 Halton texels of all maps: so much for each unit of power that about `share` of
// the VPLs are drawn by power. Any floor over 0 is right. It says only how many VPLs go where no view sample needs them.
#include "vpls/importance-view.glsl"
#include "lib/halton.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    uvec2 size;
    uint lights;
    float share;
} params;

layout(scalar) writeonly buffer FoundFloor { float it; } found;

shared vec2 sums[64];

ivec3 texel(uint index) {
    vec3 u = vec3(radical_inverse(index + 1u, 2u), radical_inverse(index + 1u, 3u), radical_inverse(index + 1u, 5u));
    return ivec3(min(ivec2(u.xy * vec2(params.size)), ivec2(params.size) - 1), min(uint(u.z * float(params.lights)), params.lights - 1u));
}

void main() {
    uint me = gl_LocalInvocationIndex;
    vec2 sum = vec2(0.0);
    ivec3 at[AT_ONCE];
    for (uint k = 0u; k < AT_ONCE; k++) at[k] = texel(AT_ONCE * me + k);
    float seen[AT_ONCE];
    importances(at, params.size, seen);
    for (uint k = 0u; k < AT_ONCE; k++) sum += vec2(seen[k], power_of(candidate(at[k], params.size)));
    sums[me] = sum;
    barrier();
    if (me > 0u) return;
    for (uint i = 1u; i < 64u; i++) sum += sums[i];
    // Where the samples see nothing important, all VPLs are drawn by power.
    float mean = sum.y > 0.0 ? sum.x / sum.y : 0.0;
    found.it = mean > 0.0 ? mean * params.share / (1.0 - params.share) : 1.0;
}
