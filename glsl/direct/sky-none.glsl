// No sky. Each part for "sky" defines the radiance that a pixel's surface reflects of the sky's light.
vec3 reflected_sky(ivec2 pixel, vec3 base, float metallic) { return vec3(0.0); }
