#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// All light of a pixel, the indirect darkened where surfaces nearby stand in its way.
#include "compose/sum.glsl"

layout(r32f) readonly uniform image2D visible;

float indirect_share(ivec2 pixel) { return imageLoad(visible, pixel).r; }
