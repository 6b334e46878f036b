#ifndef LOBE_GLSL
#define LOBE_GLSL
// A glossy VPL: light that arrives from one direction and leaves by GGX (Tokuyoshi and Harada 2017, sections 3.2 and 4.1).
#include "lib/brdf.glsl"

struct Lobe {
    vec3 flux;     // incident flux, W; 0 of a VPL without a glossy lobe
    uint normal;   // interpolated surface normal, octahedral_snorm16
    vec3 f0;       // Fresnel reflectance at normal incidence, times the glossy share of the surface
    uint incoming; // direction to the light, octahedral_snorm16
    float alpha;   // GGX alpha: roughness squared
    float f90;     // Fresnel reflectance at grazing incidence, times the glossy share
};

EXACT vec3 lobe_fresnel(vec3 f0, float f90, float cosine) {
    float m = 1.0 - clamp(cosine, 0.0, 1.0);
    return f0 + (f90 - f0) * (m * m * m * m * m);
}

// Radiant intensity towards wo, W/sr: equation 4, whose cosine cancels with the BRDF's denominator.
EXACT vec3 lobe_intensity(vec3 flux, vec3 f0, float f90, float alpha, vec3 n, vec3 wi, vec3 wo) {
    float no = exact_dot(n, wo);
    if (no <= 0.0) return vec3(0.0);
    vec3 h = normalize(wi + wo), off = cross(n, h);
    // The distribution is written with the sine. With the cosine alone, it rounds to more than its peak for small alpha, and bounds would
    // not hold.
    float a2 = alpha * alpha, nh = exact_dot(n, h), ni = exact_dot(n, wi), d = a2 * nh * nh + exact_dot(off, off);
    float v = 0.5 * no / max(ni * sqrt(no * no * (1.0 - a2) + a2) + no * sqrt(ni * ni * (1.0 - a2) + a2), 1e-7);
    return flux * lobe_fresnel(f0, f90, exact_dot(wi, h)) * (a2 / (PI * d * d) * v);
}

float largest(vec3 v) { return max(v.r, max(v.g, v.b)); }
#endif
