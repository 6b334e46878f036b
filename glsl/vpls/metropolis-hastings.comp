#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Independent Metropolis-Hastings sampling (Barak et al. 2013, section 4.3, algorithm 1): a chain a VPL. A chain proposes STEPS texels,
// and the last that it has accepted becomes the VPL. The first proposal counts among the STEPS, as the text has it, and not as printed.
#include "vpls/texel.glsl"
#include "part/points=vpls/points-halton"
#include "part/proposed=vpls/proposed-alone"
#include "vpls/place.glsl"
#include "part/weight=vpls/weight-own"

layout(constant_id = 0) const uint STEPS = 1;
// Whether a proposal is accepted with its share of the sum so far, and not with its ratio to the chain's state.
layout(constant_id = 1) const bool RESERVOIR = false;
const uint MEAN = 0u, SINGLE = 1u, NONE = 2u;
layout(constant_id = 2) const uint WEIGHTS = MEAN;

void main() {
    uint chain = gl_GlobalInvocationID.x;
    if (chain >= params.count) return;
    ivec3 at = place_of(point(chain, 0u));
    float f = importance_of(chain, 0u, at), first = f, sum = f;
    for (uint step = 1u; step < STEPS; step++) {
        vec4 u = point(chain, step);
        ivec3 proposal = place_of(u);
        float proposed = importance_of(chain, step, proposal);
        sum += proposed;
        // Never by a quotient, which 0 would spoil.
        bool accepted = RESERVOIR ? u.w * sum < proposed : proposed > u.w * f || f == 0.0;
        if (accepted) {
            at = proposal;
            f = proposed;
        }
    }
    // Weight over importance, w / f of equation 3. A chain that has met no importance, and one of a single step, sample uniformly.
    uint steps = STEPS, weights = WEIGHTS;
    float weight = 1.0;
    if (weights == MEAN && steps > 1u && f > 0.0) weight = sum / (float(steps) * f);
    if (weights == SINGLE && steps > 1u && f > 0.0) weight = first / f;
    if (weights == NONE) weight = f > 0.0 ? common_weight() / f : 0.0;
    put(chain, at, weight * (float(params.lights) * float(params.size.x) * float(params.size.y) / float(params.count)));
}
