// Candidates with GGX lobes.
#include "lib/color.glsl"
#include "lib/lobe.glsl"
#include "lib/packing.glsl"
#include "vpls/rsm.glsl"

uniform sampler2DArray rsm_specular;
uniform sampler2DArray rsm_lobe;

struct Gloss {
    vec3 normal;
    float alpha; // 0 without a lobe
    vec3 incoming;
    float flux;
    vec2 fresnel; // luminance at normal and at grazing incidence
};

bool has_gloss() { return true; }

Gloss no_gloss() { return Gloss(vec3(0.0, 0.0, 1.0), 0.0, vec3(0.0, 0.0, 1.0), 0.0, vec2(0.0)); }

EXACT Gloss gloss_of(ivec3 texel, vec3 position) {
    vec4 specular = texelFetch(rsm_specular, texel, 0);
    if (specular.a <= 0.0) return no_gloss();
    vec4 shape = texelFetch(rsm_lobe, texel, 0);
    Light light = lights.at[texel.z];
    vec3 incoming = light.kind == DIRECTIONAL ? -light.direction : normalize(light.origin - position);
    return Gloss(octahedral_inverse(shape.xy), shape.z, incoming, luminance(texelFetch(rsm_flux, texel, 0).rgb),
                 vec2(luminance(specular.rgb), specular.a));
}

EXACT float gloss_towards(Gloss gloss, vec3 way) {
    if (gloss.flux <= 0.0) return 0.0;
    return lobe_intensity(vec3(gloss.flux), vec3(gloss.fresnel.x), gloss.fresnel.y, gloss.alpha, gloss.normal, gloss.incoming, way).x;
}

EXACT float gloss_power(Gloss gloss) { return gloss.flux * max(gloss.fresnel.x, gloss.fresnel.y) / PI; }
