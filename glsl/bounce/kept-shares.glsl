// VPLs of which it is known how much of their light stays in the scene. They count by what they light: a roof that shines into the sky lies near
// no court's VPLs in that, though it may in place and normal.
#include "lib/color.glsl"

layout(scalar) readonly buffer Kept { float at[]; } kept_shares;

float kept(uint i) { return kept_shares.at[i]; }

// The flux that it sends on, up to a factor.
float counts(uint i) { return kept(i) * luminance(intensities.at[i]); }
