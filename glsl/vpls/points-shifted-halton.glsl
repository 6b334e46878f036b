// Halton points, each step of the chains rotated by random numbers of its own: the steps are independent of each other.
#include "lib/halton.glsl"
#include "lib/random.glsl"

vec4 point(uint index, uint step) {
    uint k = index + step * params.count + 1u;
    vec4 halton = vec4(radical_inverse(k, params.bases.x), radical_inverse(k, params.bases.y), radical_inverse(k, params.bases.z),
                       radical_inverse(k, params.bases.w));
    return fract(halton + random(step, 0u, 1u, params.seed));
}

float share(uint index) { return 1.0 / float(params.count); }
