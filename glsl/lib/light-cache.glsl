#ifndef LIGHT_CACHE_GLSL
#define LIGHT_CACHE_GLSL
// A light cache as it stands in the world.
struct LightCache {
    vec3 position;
    float area;       // surface that it stands for, m^2
    vec3 normal;
    uint one_of_two;  // whether it is on one side of a surface that has two
};

// The light that stands for all VALs at a cache.
struct ProxyLight {
    vec3 way;         // from the cache to its place
    float extent;     // largest standard deviation of the VALs' places along an axis, metres
    vec3 irradiance;  // at the cache, without shadows, W/m^2
};

const uint NO_CACHE = 0xffffffffu;
#endif
