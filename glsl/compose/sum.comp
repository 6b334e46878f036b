#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// All light of a pixel.
#include "compose/sum.glsl"

float indirect_share(ivec2 pixel) { return 1.0; }
