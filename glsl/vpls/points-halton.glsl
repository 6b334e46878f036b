// Halton points over light, column, row and acceptance. Each part for "points" defines
//     vec4 point(uint index, uint step); // of VPL `index`, proposal `step` of its chain
//     float share(uint index);           // probability of drawing the VPL's point: the VPLs' shares sum to 1
// The bases divide neither the number of chains nor that of the sample sets: src/stages/vpls/points.rs.
#include "lib/halton.glsl"

vec4 point(uint index, uint step) {
    // Point 0 is a corner and is skipped.
    uint k = params.start + index + step * params.count + 1u;
    return vec4(radical_inverse(k, params.bases.x), radical_inverse(k, params.bases.y), radical_inverse(k, params.bases.z),
                radical_inverse(k, params.bases.w));
}

float share(uint index) { return 1.0 / float(params.count); }
