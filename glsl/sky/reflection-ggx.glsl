// Receivers with gloss: metals, and dielectrics under a coat. A lobe is at least as wide as a direction's part of the sky.
#include "lib/brdf.glsl"

layout(constant_id = 3) const bool GLOSSY_DIELECTRIC = false;

layout(rgba16f) readonly uniform image2D albedo;
uniform sampler2D metallic_roughness;
layout(rgba16f) writeonly uniform image2D reflection; // radiance to the eye

vec3 reflected = vec3(0.0);
vec3 base;
vec2 surface; // metallic, and GGX's alpha
vec3 to_eye;

void begin_reflection(Receiver r) {
    base = imageLoad(albedo, r.pixel).rgb;
    vec2 mr = texelFetch(metallic_roughness, r.pixel, 0).rg;
    surface = vec2(mr.x, max(mr.y * mr.y, params.least_alpha));
    to_eye = normalize(view.it.position - r.position);
}

float reflect_to_eye(Receiver r, vec3 to_light, vec3 irradiance) {
    bool glossy = surface.x > 0.0;
    if (GLOSSY_DIELECTRIC) glossy = true;
    if (!glossy) return 1.0;
    vec3 h = normalize(to_light + to_eye);
    float vh = max(dot(to_eye, h), 0.0), coat = 0.0;
    if (GLOSSY_DIELECTRIC) coat = coat_fresnel(vh);
    float lobe = ggx(surface.y, max(dot(r.normal, h), 0.0), max(dot(r.normal, to_light), 0.0), max(dot(r.normal, to_eye), 1e-4));
    reflected += irradiance * (lobe * mix(vec3(coat), schlick(base, vh), surface.x));
    return 1.0 - coat;
}

void end_reflection(Receiver r) {
    imageStore(reflection, r.pixel, vec4(min(reflected * float(SETS), LARGEST_HALF), 1.0));
}
