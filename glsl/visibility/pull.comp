#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// A pull from one coarse level to the next.
const float SPREAD = 1.0;
#include "visibility/pull.glsl"

layout(rg32ui) readonly uniform uimage2D finer;

bool finer_texel(ivec2 texel, out Pulled p) {
    uvec2 words = imageLoad(finer, texel).rg;
    p = unpack_pulled(words);
    return words.x != EMPTY;
}

layout(rg32ui) writeonly uniform uimage2D coarser;

void put(ivec2 texel, bool there, Pulled p) {
    imageStore(coarser, texel, there ? uvec4(pack_pulled(p), 0u, 0u) : uvec4(EMPTY, EMPTY, 0u, 0u));
}
