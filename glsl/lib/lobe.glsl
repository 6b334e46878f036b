#ifndef LOBE_GLSL
#define LOBE_GLSL
// A glossy VPL: light that arrives from one direction and leaves by GGX (Tokuyoshi and Harada 2017, sections 3.2 and 4.1).
#include "lib/brdf.glsl"

struct Lobe {
    vec3 flux;     // that arrives, W; 0 where nothing is reflected so
    uint normal;   // the surface's interpolated one, octahedral_snorm16
    vec3 f0;       // Fresnel reflectance along the normal, times how much of the surface reflects so
    uint incoming; // where the light comes from, octahedral_snorm16
    float alpha;   // of GGX: roughness squared
    float f90;     // Fresnel reflectance at a grazing angle, likewise
};

vec3 lobe_fresnel(vec3 f0, float f90, float cosine) {
    float m = 1.0 - clamp(cosine, 0.0, 1.0);
    return f0 + (f90 - f0) * (m * m * m * m * m);
}

// Radiant intensity, W/sr, towards wo: equation 4, whose cosine the BRDF's denominator takes.
vec3 lobe_intensity(vec3 flux, vec3 f0, float f90, float alpha, vec3 n, vec3 wi, vec3 wo) {
    float no = dot(n, wo);
    if (no <= 0.0) return vec3(0.0);
    vec3 h = normalize(wi + wo), off = cross(n, h);
    // The distribution by the sine: by the cosine alone it rounds to more than its peak where alpha is small, and bounds would not hold.
    float a2 = alpha * alpha, nh = dot(n, h), ni = dot(n, wi), d = a2 * nh * nh + dot(off, off);
    float v = 0.5 * no / max(ni * sqrt(no * no * (1.0 - a2) + a2) + no * sqrt(ni * ni * (1.0 - a2) + a2), 1e-7);
    return flux * lobe_fresnel(f0, f90, dot(wi, h)) * (a2 / (PI * d * d) * v);
}

float largest(vec3 v) { return max(v.r, max(v.g, v.b)); }
#endif
