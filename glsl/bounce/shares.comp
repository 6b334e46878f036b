#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Number of VPLs of the next bounce for each cluster: equal, or in proportion to the flux that the cluster sends on. By flux, VPLs are
// about equally strong, and none are spent on a cluster that sees the sky. There is one workgroup, which estimates that flux with a few
// samples of each map.
#include "bounce/map.glsl"
#include "lib/color.glsl"
#include "lib/hammersley.glsl"
#include "lib/pi.glsl"

const uint INVOCATIONS = 256u;
layout(local_size_x = 256) in;
layout(constant_id = 0) const bool BY_FLUX = true;

layout(scalar, push_constant) uniform Params {
    uint count;    // VPLs
    uint clusters;
    int size;      // of a map
} params;

layout(scalar) readonly buffer Clusters { VplCluster at[]; } clusters;
uniform sampler2DArray distances;
uniform sampler2DArray albedos;
layout(scalar) writeonly buffer Starts { uint at[]; } starts; // first VPL of each cluster, and the number of VPLs last

const uint SAMPLES = 4u; // samples of a map by one invocation
shared float sums[INVOCATIONS];
shared float passed[MOST_CLUSTERS];

void main() {
    uint me = gl_LocalInvocationIndex;
    for (uint j = 0u; j < params.clusters; j++) {
        float sum = 0.0;
        for (uint i = 0u; i < SAMPLES; i++) {
            vec2 u = hammersley(me * SAMPLES + i, INVOCATIONS * SAMPLES);
            vec2 p = sqrt(u.x) * vec2(cos(2.0 * PI * u.y), sin(2.0 * PI * u.y));
            ivec3 texel = ivec3(clamp(ivec2((p * 0.5 + 0.5) * float(params.size)), ivec2(0), ivec2(params.size - 1)), int(j));
            if (texelFetch(distances, texel, 0).r >= 1.0) continue;
            float squared = dot(p, p), one = 1.0 + squared;
            sum += luminance(clusters.at[j].flux * texelFetch(albedos, texel, 0).rgb) * (1.0 - squared) / (one * one * one);
        }
        sums[me] = BY_FLUX ? sum : 1.0;
        barrier();
        for (uint step = INVOCATIONS / 2u; step > 0u; step /= 2u) {
            if (me < step) sums[me] += sums[me + step];
            barrier();
        }
        if (me == 0u) passed[j] = sums[0];
        barrier();
    }
    if (me > 0u) return;
    // Each cluster gets at least one VPL if there are enough.
    float total = 0.0;
    for (uint j = 0u; j < params.clusters; j++) total += passed[j];
    uint least = params.count >= params.clusters ? 1u : 0u, free = params.count - least * params.clusters;
    float before = 0.0;
    for (uint j = 0u; j < params.clusters; j++) {
        float part = total > 0.0 ? before / total : float(j) / float(params.clusters);
        starts.at[j] = least * j + min(uint(part * float(free)), free);
        before += passed[j];
    }
    starts.at[params.clusters] = params.count;
}
