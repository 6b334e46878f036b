// Receivers with gloss: metals, and dielectrics under a coat. Their lobe is that of the caches (equation 4), so that a pixel at a cache
// reflects what the cache does.
#include "lib/brdf.glsl"

layout(constant_id = 7) const bool GLOSSY_DIELECTRIC = false;

layout(location = 1) out vec4 reflection; // radiance to the eye

uniform sampler2D albedo;
uniform sampler2D metallic_roughness;

// Cosine between the direction to the eye and the half vector.
float half_cosine(vec3 to_eye, vec3 to_light) {
    vec3 between = to_light + to_eye;
    return max(dot(to_eye, between) * inversesqrt(max(dot(between, between), 1e-20)), 0.0);
}

float coat_of(vec3 to_eye, vec3 to_light) { return GLOSSY_DIELECTRIC ? coat_fresnel(half_cosine(to_eye, to_light)) : 0.0; }

float mirror(Receiver r, vec3 to_light) {
    vec3 base = texelFetch(albedo, r.pixel, 0).rgb;
    vec2 mr = texelFetch(metallic_roughness, r.pixel, 0).rg;
    vec3 to_eye = normalize(view.it.position - r.position);
    Arriving glossy = arriving(1u, r.normal);
    float exponent = lobe_exponent(mr.y);
    float lobe = (exponent + 2.0) / (2.0 * PI) * cosine_lobe(dot(reflect(-to_eye, r.normal), glossy.to_light), exponent);
    vec3 fresnel = mix(vec3(coat_of(to_eye, glossy.to_light)), schlick(base, half_cosine(to_eye, glossy.to_light)), mr.x);
    reflection = vec4(min(glossy.light * lobe * fresnel, vec3(LARGEST_HALF)), 1.0);
    return 1.0 - coat_of(to_eye, to_light);
}
