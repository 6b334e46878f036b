#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Distance and radius of the nearest point in each texel.
#include "visibility/single-pixel.glsl"

layout(r32ui) uniform uimage2D target;
layout(scalar) buffer Dropped { uint count; } dropped;
layout(scalar) buffer Drawn { uint count; } drawn;

void put(ivec2 texel, uint word, vec3 normal, vec3 w, vec2 p) {
    // Most points lose, and a load is cheaper than an atomic.
    if (word < imageLoad(target, texel).r) imageAtomicMin(target, texel, word);
}

void put_total(uint total, uint lost) {
    if (total > 0u) atomicAdd(drawn.count, total);
    if (lost > 0u) atomicAdd(dropped.count, lost);
}
