// A sky of the same radiance everywhere. Each part for "radiance" defines
//     vec3 sky_radiance(vec3 w);
// the radiance from the direction w, of any length.
layout(scalar) uniform SkyBlock {
    vec3 radiance;
    float turn;
} sky;

vec3 sky_radiance(vec3 w) { return sky.radiance; }
