// VPLs count by the light that they leave in the scene. A roof that shines into the sky may be near to a court's VPLs in place and normal, and is not
// in that.
#include "lib/color.glsl"

layout(scalar) readonly buffer Kept { float at[]; } kept_shares;

float kept(uint i) { return kept_shares.at[i]; }

// The flux that the VPL sends on, up to a factor.
float counts(uint i) { return kept(i) * luminance(intensities.at[i]); }
