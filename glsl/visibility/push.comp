#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// A push from one coarse level to the next finer one.
#include "visibility/push-disk.glsl"

layout(rg32ui) uniform uimage2D finer;

bool finer_texel(ivec2 texel, out float depth) {
    uint word = imageLoad(finer, texel).r;
    depth = pixel_depth(word);
    return word != EMPTY;
}

void fill_texel(ivec2 texel, Pulled p) { imageStore(finer, texel, uvec4(pack_pulled(p), 0u, 0u)); }
void keep_texel(ivec2 texel, bool there, float depth) {}
