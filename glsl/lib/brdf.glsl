#ifndef BRDF_GLSL
#define BRDF_GLSL
// BRDFs: Lambert, and GGX with the height-correlated Smith term (Heitz 2014). Units: src/stages/README.md.
#include "lib/exact.glsl"
#include "lib/pi.glsl"

EXACT vec3 schlick(vec3 f0, float cosine) {
    float m = 1.0 - clamp(cosine, 0.0, 1.0);
    return f0 + (1.0 - f0) * (m * m * m * m * m);
}

// Fresnel reflectance of a glossy dielectric's coat.
EXACT float coat_fresnel(float cosine) { return schlick(vec3(0.04), cosine).x; }

// D V of GGX, 1/sr, without Fresnel; cosines of half vector, light and view to the normal.
EXACT float ggx(float alpha, float nh, float nl, float nv) {
    float a2 = alpha * alpha;
    float d = nh * nh * (a2 - 1.0) + 1.0;
    float v = nl * sqrt(nv * nv * (1.0 - a2) + a2) + nv * sqrt(nl * nl * (1.0 - a2) + a2);
    return a2 / (PI * d * d) * 0.5 / max(v, 1e-7);
}

// BRDF of a mix of metal and dielectric, 1/sr. A dielectric is pure Lambert unless `glossy_dielectric`.
EXACT vec3 brdf(vec3 albedo, float metallic, float roughness, bool glossy_dielectric, vec3 n, vec3 l, vec3 v) {
    vec3 h = normalize(l + v);
    float nl = max(exact_dot(n, l), 0.0), nv = max(exact_dot(n, v), 1e-4), nh = max(exact_dot(n, h), 0.0), vh = max(exact_dot(v, h), 0.0);
    float alpha = max(roughness * roughness, 1e-3);
    vec3 dielectric = albedo / PI;
    vec3 metal = vec3(0.0);
    if (glossy_dielectric) {
        float f = coat_fresnel(vh);
        dielectric = (1.0 - f) * dielectric + f * ggx(alpha, nh, nl, nv);
    }
    if (metallic > 0.0) metal = schlick(albedo, vh) * ggx(alpha, nh, nl, nv);
    return mix(dielectric, metal, metallic);
}
#endif
