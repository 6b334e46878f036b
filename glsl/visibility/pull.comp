#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Pull from one coarse level to the next.
#include "visibility/pull.glsl"

layout(PULLED_FORMAT) readonly uniform uimage2D finer;

bool finer_texel(ivec2 texel, out Pulled p) {
    uvec4 words = imageLoad(finer, texel);
    p = pulled_from(words);
    return words.x != EMPTY;
}
