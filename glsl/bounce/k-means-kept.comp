#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// For VPLs of which it is known how much of their light stays in the scene.
#include "bounce/k-means.glsl"
#include "lib/color.glsl"

layout(scalar) readonly buffer Kept { float at[]; } kept_shares;

float kept(uint i) { return kept_shares.at[i]; }

// The flux that it passes on, up to a factor.
float counts(uint i) { return kept(i) * luminance(intensities.at[i]); }
