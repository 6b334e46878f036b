// Light of the sky on all surfaces, filtered.
layout(rgba16f) readonly uniform image2D sky_irradiance;
layout(rgba16f) readonly uniform image2D sky_reflection;

vec3 reflected_sky(ivec2 pixel, vec3 base, float metallic) {
    return imageLoad(sky_irradiance, pixel).rgb * base * ((1.0 - metallic) / PI) + imageLoad(sky_reflection, pixel).rgb;
}
