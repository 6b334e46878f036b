#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
// Importance of the chains' proposals alone (Barak et al. 2013, section 4.3). Proposals hang on no earlier step, so all are worked out at
// once. An invocation has four of them.
#include "vpls/params.glsl"
#include "part/importance=vpls/importance-none"
#include "part/points=vpls/points-halton"
#include "vpls/place.glsl"

layout(constant_id = 0) const uint STEPS = 1; // proposals of a chain

layout(scalar) writeonly buffer Proposed { float at[]; } proposed; // step by step

ivec3 place(uint number) { return place_of(point(number % params.count, min(number / params.count, STEPS - 1u))); }

void main() {
    uint first = 4u * gl_GlobalInvocationID.x;
    vec4 found = importances(place(first), place(first + 1u), place(first + 2u), place(first + 3u), params.size);
    for (uint i = 0u; i < 4u; i++) {
        if (first + i < params.count * STEPS) proposed.at[first + i] = found[i];
    }
}
