// Receivers with gloss: metals, and dielectrics under a coat. A lobe is at least as wide as a direction's part of the sky.
#include "lib/brdf.glsl"

layout(constant_id = 3) const bool GLOSSY_DIELECTRIC = false;

layout(rgba16f) readonly uniform image2D albedo;
uniform sampler2D metallic_roughness;
layout(rgba16f) writeonly uniform image2D reflection; // radiance to the eye

struct Reflection {
    vec3 sum; // radiance to the eye so far
    vec3 albedo;
    float metallic;
    float alpha; // GGX's
    vec3 to_eye;
};

Reflection reflection_at(Receiver r) {
    Reflection g = Reflection(vec3(0.0), vec3(0.0), 0.0, 1.0, vec3(0.0));
    if (r.distance > 0.0) {
        vec2 mr = texelFetch(metallic_roughness, r.pixel, 0).rg;
        g.albedo = imageLoad(albedo, r.pixel).rgb;
        g.metallic = mr.x;
        g.alpha = max(mr.y * mr.y, params.least_alpha);
        g.to_eye = normalize(view.it.position - r.position);
    }
    return g;
}

float reflect_to_eye(inout Reflection g, Receiver r, vec3 to_light, vec3 irradiance) {
    bool glossy = g.metallic > 0.0;
    if (GLOSSY_DIELECTRIC) glossy = true;
    if (!glossy) return 1.0;
    vec3 h = normalize(to_light + g.to_eye);
    float vh = max(dot(g.to_eye, h), 0.0), coat = 0.0;
    if (GLOSSY_DIELECTRIC) coat = coat_fresnel(vh);
    float lobe = ggx(g.alpha, max(dot(r.normal, h), 0.0), max(dot(r.normal, to_light), 0.0), max(dot(r.normal, g.to_eye), 1e-4));
    g.sum += irradiance * (lobe * mix(vec3(coat), schlick(g.albedo, vh), g.metallic));
    return 1.0 - coat;
}

void store(Receiver r, Reflection g) {
    imageStore(reflection, r.pixel, vec4(min(g.sum * float(SETS), LARGEST_HALF), 1.0));
}
