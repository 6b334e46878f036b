// VPLs with a known share of light that stays in the scene, and weights by the light that they send into it. A roof that shines into the
// sky has little in common with VPLs of a courtyard, even if position and normal are similar.
#include "lib/color.glsl"

layout(scalar) readonly buffer Kept { float at[]; } kept_shares;

float kept(uint i) { return kept_shares.at[i]; }

// Flux that the VPL sends on into the scene, up to a factor.
float counts(uint i) { return kept(i) * luminance(intensities.at[i]); }
