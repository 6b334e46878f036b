// VPLs that are diffuse alone. Each part for "lobe" stores the glossy VPL beside a diffuse one, and says whether there is one. A texel without a surface
// has the layer -1.
bool put_lobe(uint index, ivec3 at, float texels, vec3 position) { return false; }
