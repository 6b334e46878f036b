// A Hammersley set over light and row in one, and column, in the order of a fixed permutation.
#include "lib/hammersley.glsl"
#include "lib/permutation.glsl"

vec4 point(uint index, uint step) {
    vec2 u = fract(hammersley(permutation(index, params.count), params.count) + params.shift.xy);
    return vec4(u.x, u.y, 0.0, 0.0);
}

float share(uint index) { return 1.0 / float(params.count); }
