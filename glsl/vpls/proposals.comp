#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Importance of the chains' proposals alone (Barak et al. 2013, section 4.3). Proposals depend on no earlier step, so all are
// worked out at once. An invocation has one step of AT_ONCE chains.
#include "vpls/params.glsl"
#include "part/importance=vpls/importance-none"
#include "part/points=vpls/points-halton"
#include "vpls/place.glsl"

layout(scalar) writeonly buffer Proposed { float at[]; } proposed; // step by step

// Proposal of a chain, or of the last one beyond it.
ivec3 place(uint chain) { return place_of(point(min(chain, params.count - 1u), gl_GlobalInvocationID.y)); }

void main() {
    uint first = AT_ONCE * gl_GlobalInvocationID.x;
    ivec3 at[AT_ONCE];
    for (uint k = 0u; k < AT_ONCE; k++) at[k] = place(first + k);
    float found[AT_ONCE];
    importances(at, params.size, found);
    for (uint k = 0u; k < AT_ONCE; k++) {
        if (first + k < params.count) proposed.at[gl_GlobalInvocationID.y * params.count + first + k] = found[k];
    }
}
