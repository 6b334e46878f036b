#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The first pull where normals are kept: from single pixels, and how their surfaces are tilted.
// The ellipses reach far enough.
const float SPREAD = 0.0;
#include "visibility/pull.glsl"
#include "visibility/tilt.glsl"

layout(constant_id = 0) const uint MAP_SIZE = 64;
layout(constant_id = 1) const bool DISTORTION = true;

layout(r32ui) readonly uniform uimage2D finer;
layout(r32ui) readonly uniform uimage2D tilts;

bool finer_texel(ivec2 texel, out Pulled p) {
    uint word = imageLoad(finer, texel).r;
    p = Pulled(pixel_depth(word), pixel_radius(word), 0.0, vec2(0.0), unpack_tilt(imageLoad(tilts, texel).r));
    // The interval is as deep as the tilted disk, in the world: the projection's scale undone.
    vec2 place = (vec2(texel & int(MAP_SIZE - 1u)) + 0.5) * (2.0 / float(MAP_SIZE)) - 1.0;
    float scale = 4.0;
    if (DISTORTION) scale = 4.0 / (1.0 + dot(place, place));
    p.extent = 2.0 * max(length(p.tilt), 0.5) * p.radius * p.depth * scale / float(MAP_SIZE);
    return word != EMPTY;
}

layout(rgba32ui) writeonly uniform uimage2D coarser;

void put(ivec2 texel, bool there, Pulled p) {
    imageStore(coarser, texel, there ? uvec4(pack_pulled(p), pack_tilt(p.tilt), 0u) : uvec4(EMPTY, EMPTY, 0u, 0u));
}
