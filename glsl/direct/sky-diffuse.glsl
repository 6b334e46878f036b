// Light of the sky on surfaces without gloss, filtered.
layout(rgba16f) readonly uniform image2D sky_irradiance;

vec3 reflected_sky(ivec2 pixel, vec3 base, float metallic) { return imageLoad(sky_irradiance, pixel).rgb * base * ((1.0 - metallic) / PI); }
