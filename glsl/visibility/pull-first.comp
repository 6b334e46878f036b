#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The first pull: from single pixels, which have a distance and a radius alone.
const float SPREAD = 1.0;
#include "visibility/pull.glsl"

layout(constant_id = 0) const uint MAP_SIZE = 64;
layout(constant_id = 1) const bool DISTORTION = true;

layout(r32ui) readonly uniform uimage2D finer;

bool finer_texel(ivec2 texel, out Pulled p) {
    uint word = imageLoad(finer, texel).r;
    p = Pulled(pixel_depth(word), pixel_radius(word), 0.0, vec2(0.0), vec2(0.0));
    // The interval is the diameter in the world: the projection's scale undone, and, on the average of all angles, what the disk
    // lost by being seen aslant.
    vec2 place = (vec2(texel & int(MAP_SIZE - 1u)) + 0.5) * (2.0 / float(MAP_SIZE)) - 1.0;
    float scale = DISTORTION ? 6.0 / (1.0 + dot(place, place)) : 4.0;
    p.extent = 2.0 * p.radius * p.depth * scale / float(MAP_SIZE);
    return word != EMPTY;
}

layout(rg32ui) writeonly uniform uimage2D coarser;

void put(ivec2 texel, bool there, Pulled p) {
    imageStore(coarser, texel, there ? uvec4(pack_pulled(p), 0u, 0u) : uvec4(EMPTY, EMPTY, 0u, 0u));
}
