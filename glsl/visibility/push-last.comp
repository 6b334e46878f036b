#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Last push: distances alone, for the gather.
#include "visibility/push.glsl"

layout(r32ui) readonly uniform uimage2D finer;
layout(r32f) writeonly uniform image2D maps;

bool finer_texel(ivec2 texel, out float depth) {
    uint word = imageLoad(finer, texel).r;
    depth = pixel_depth(word);
    return word != EMPTY;
}

void fill_texel(ivec2 texel, Pulled p) { imageStore(maps, texel, vec4(p.depth)); }
void keep_texel(ivec2 texel, bool there, float depth) { imageStore(maps, texel, vec4(there ? depth : 1.0)); }
