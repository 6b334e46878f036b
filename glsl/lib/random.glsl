#ifndef RANDOM_GLSL
#define RANDOM_GLSL
// Counter-based random numbers: a sample's numbers depend on its indices alone (PCG4D, Jarzynski and Olano 2020).
uvec4 pcg4d(uvec4 v) {
    v = v * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// Four numbers in [0, 1), from a pixel, its sample, a dimension and a seed.
vec4 random(uint pixel, uint sample_index, uint dimension, uint seed) {
    return vec4(pcg4d(uvec4(pixel, sample_index, dimension, seed)) >> 8u) / 16777216.0;
}
#endif
