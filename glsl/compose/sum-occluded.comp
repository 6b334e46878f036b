#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// All light of a pixel, the indirect darkened where surfaces nearby stand in its way.
#include "compose/sum.glsl"

uniform sampler2D visible;

float indirect_share(ivec2 pixel) { return texelFetch(visible, pixel, 0).r; }
