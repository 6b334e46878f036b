// Independent random points.
#include "lib/random.glsl"

vec4 point(uint index, uint step) { return random(index, step, 2u, params.seed); }

float share(uint index) { return 1.0 / float(params.count); }
