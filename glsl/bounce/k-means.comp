#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// All of the light of VPLs may stay in the scene.
#include "bounce/k-means.glsl"

float kept(uint i) { return 1.0; }
