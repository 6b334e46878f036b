// Texel of a reflective shadow map as a candidate for a virtual point light.
#include "lib/color.glsl"
#include "lib/packing.glsl"
#include "lib/pi.glsl"
#include "vpls/rsm.glsl"

struct Candidate {
    vec3 position;
    vec3 normal;
    float brightness; // luminance of its radiant intensity along the normal, W/sr; 0 without a surface or light
    Gloss gloss;
};

EXACT Candidate candidate(ivec3 at, uvec2 size) {
    float depth = texelFetch(rsm_depth, at, 0).r;
    if (depth == 0.0) return Candidate(vec3(0.0), vec3(0.0, 0.0, 1.0), 0.0, no_gloss());
    vec2 ndc = (vec2(at.xy) + 0.5) / vec2(size) * 2.0 - 1.0;
    vec3 position = light_position(lights.at[at.z], ndc, depth), normal = octahedral_inverse(texelFetch(rsm_normal, at, 0).xy);
    float brightness = luminance(texelFetch(rsm_flux, at, 0).rgb * texelFetch(rsm_albedo, at, 0).rgb) / PI;
    return Candidate(position, normal, brightness, gloss_of(at, position));
}
