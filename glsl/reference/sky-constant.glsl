// A constant sky, which paths meet by chance: no direction of it is worth sampling more than another. Each part for "sky" defines
// sky_radiance as in sky/radiance-constant.glsl, SKY_SAMPLED, and
//     float sky_density(vec3 w);
//     vec3 sample_sky(vec2 u, out vec3 w, out float density);
// the density of sampled directions, 1/sr, and a direction's radiance over its density.
#include "sky/radiance-constant.glsl"

const bool SKY_SAMPLED = false;

float sky_density(vec3 w) { return 0.0; }

vec3 sample_sky(vec2 u, out vec3 w, out float density) {
    w = vec3(0.0, 1.0, 0.0);
    density = 0.0;
    return vec3(0.0);
}
