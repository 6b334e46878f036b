#ifndef LIGHT_CACHE_GLSL
#define LIGHT_CACHE_GLSL
// A light cache as it stands in the world.
struct LightCache {
    vec3 position;
    float area;       // surface that it stands for, m^2
    vec3 normal;
    float exponent;   // of its surface's cosine lobe
    float silhouette; // area that its surface is spread over, seen along the normal, m^2
    float opacity;    // share of that which the surface covers
    uint one_of_two;  // whether it is on one side of a surface that has two
};

// A light that stands for all VALs at a cache. A cache has one for its diffuse light and, if receivers are glossy, one for its glossy light.
struct ProxyLight {
    vec3 way;         // from the cache to its place
    float extent;     // largest standard deviation of the VALs' places along an axis, metres
    vec3 irradiance;  // at the cache, without shadows, W/m^2
};

const uint NO_CACHE = 0xffffffffu;

// Exponent k of the cosine lobe about the mirror direction: a quarter of 2 / alpha^2 - 2, that of the half vector's lobe as high as GGX's. A
// lobe is no narrower than that of roughness 0.2, since a cache has one light for all of it.
float lobe_exponent(float roughness) {
    float alpha = max(roughness * roughness, 0.04);
    return max(0.5 / (alpha * alpha) - 0.5, 0.0);
}

// Direction from which a mirror with this normal reflects to the eye, given the vector from the eye to it, which may be 0.
vec3 mirror_direction(vec3 from_eye, vec3 normal) {
    return reflect(from_eye * inversesqrt(max(dot(from_eye, from_eye), 1e-20)), normal);
}

// cos^k of a lobe, 0 behind.
float cosine_lobe(float cosine, float exponent) { return cosine > 1e-12 ? exp2(exponent * log2(min(cosine, 1.0))) : 0.0; }

// Mean of the clamped cosines to the places that a proxy stands for, given the cosine to its middle, the square of its distance and its extent.
// Where its middle is below the horizon, a part of it is above. It is the cosine itself for a proxy wholly above, and for one without extent.
float proxy_cosine(float cosine, float squared, float extent) {
    float width = extent * inversesqrt(max(squared + extent * extent, 1e-30));
    if (cosine >= width) return cosine;
    float above = max(cosine + width, 0.0);
    return above * above / max(4.0 * width, 1e-30);
}
#endif
