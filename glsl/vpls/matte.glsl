// For samplers whose VPLs are diffuse alone.
#include "vpls/texel.glsl"

bool put_lobe(uint index, ivec3 at, float texels, vec3 position) { return false; }
