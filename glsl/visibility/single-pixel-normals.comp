#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Tilts of the nearest points, in a second pass over all points, since no atomic writes both words at once: a point that finds its own word
// in the map has won. If two points have the same word, the lesser tilt stays, whatever their order.
#include "visibility/single-pixel.glsl"
#include "visibility/tilt.glsl"

layout(r32ui) readonly uniform uimage2D target;
layout(r32ui) uniform uimage2D tilts;

void put(ivec2 texel, uint word, vec3 normal, vec3 w, vec2 p) {
    if (imageLoad(target, texel).r == word) imageAtomicMin(tilts, texel, pack_tilt(tilt_of(normal, w, p)));
}

void put_total(uint total, uint lost) {}
