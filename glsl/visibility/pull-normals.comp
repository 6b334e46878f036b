#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// A pull from one coarse level to the next where normals are kept.
// The ellipses reach far enough.
const float SPREAD = 0.0;
#include "visibility/pull.glsl"
#include "visibility/tilt.glsl"

layout(rgba32ui) readonly uniform uimage2D finer;

bool finer_texel(ivec2 texel, out Pulled p) {
    uvec3 words = imageLoad(finer, texel).rgb;
    p = unpack_pulled(words.xy);
    p.tilt = unpack_tilt(words.z);
    return words.x != EMPTY;
}

layout(rgba32ui) writeonly uniform uimage2D coarser;

void put(ivec2 texel, bool there, Pulled p) {
    imageStore(coarser, texel, there ? uvec4(pack_pulled(p), pack_tilt(p.tilt), 0u) : uvec4(EMPTY, EMPTY, 0u, 0u));
}
