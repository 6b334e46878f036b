#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Shadow rays between light caches and VALs: an invocation traces those of one cache and 32 VALs.
#include "bvh/hole.glsl"
#include "lib/light-cache.glsl"
#include "lib/packing.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 32) in;

layout(scalar, push_constant) uniform Params {
    uint caches;
    uint count; // of VALs
    float off;  // distance by which ends are lifted off their surfaces, metres
} params;

layout(scalar) readonly buffer Caches { LightCache at[]; } caches;
layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Areas { float at[]; } areas;
layout(scalar) writeonly buffer Bits { uint at[]; } bits;

void main() {
    uint words = (params.count + 31u) / 32u;
    uint number = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint word = gl_WorkGroupID.z * 32u + gl_LocalInvocationID.x;
    if (number >= params.caches || word >= words) return;
    LightCache cache = caches.at[number];
    vec3 from = off_surface(cache.position + cache.normal * params.off, cache.normal);
    uint seen = 0u;
    for (uint i = 0u; i < 32u; i++) {
        uint index = word * 32u + i;
        if (index >= params.count) break;
        VplPlace place = places.at[index];
        vec3 facing = octahedral_snorm16_inverse(place.normal), way = place.position - cache.position;
        // Traced only if light would arrive.
        if (dot(cache.normal, way) > 0.0 && dot(facing, way) < 0.0 && areas.at[index] > 0.0) {
            vec3 to = off_surface(place.position + facing * params.off, facing);
            seen |= is_occluded(make_ray(from, to - from), 1.0) ? 0u : 1u << i;
        }
    }
    bits.at[number * words + word] = seen;
}
