// Points in holes are left out.
#include "visibility/masks.glsl"

bool is_hole(uint material, uvec3 corners, vec3 weights) { return lacks(material, corners, weights); }
