#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Push from one coarse level to the next finer one.
#include "visibility/push.glsl"

layout(PULLED_FORMAT) uniform uimage2D finer;

bool finer_texel(ivec2 texel, out float depth) {
    uint word = imageLoad(finer, texel).r;
    depth = pixel_depth(word);
    return word != EMPTY;
}

void fill_texel(ivec2 texel, Pulled p) { imageStore(finer, texel, pulled_words(p)); }
void keep_texel(ivec2 texel, bool there, float depth) {}
