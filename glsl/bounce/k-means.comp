#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// All of the light of VPLs may stay in the scene, and each counts as much as any other, as in the paper.
#include "bounce/k-means.glsl"

float kept(uint i) { return 1.0; }
float counts(uint i) { return 1.0; }
