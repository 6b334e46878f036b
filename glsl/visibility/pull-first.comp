#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// First pull, from single pixels.
#include "visibility/pull.glsl"

layout(constant_id = 0) const uint MAP_SIZE = 64;
layout(constant_id = 1) const bool DISTORTION = true;

layout(r32ui) readonly uniform uimage2D finer;
#include "part/extent=visibility/extent-facing"

bool finer_texel(ivec2 texel, out Pulled p) {
    uint word = imageLoad(finer, texel).r;
    vec2 place = (vec2(texel & int(MAP_SIZE - 1u)) + 0.5) * (2.0 / float(MAP_SIZE)) - 1.0;
    p = Pulled(pixel_depth(word), pixel_radius(word), 0.0, vec2(0.0), vec2(0.0));
    put_extent(texel, place, p);
    return word != EMPTY;
}
