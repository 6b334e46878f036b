// No surface is masked.
bool is_masked(uint material) { return false; }
bool is_hole(uint material, uvec3 corners, vec3 weights) { return false; }
