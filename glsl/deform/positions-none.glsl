// Nothing reads positions without other attributes.
void keep_position(uint i, vec3 position) {}
