// VPLs are diffuse alone. Each part for "lobe" defines
//     bool put_lobe(uint index, ivec3 at, float texels, vec3 position);
// which stores the glossy VPL beside a diffuse one, and says whether there is one; a texel without a surface has the layer -1.
bool put_lobe(uint index, ivec3 at, float texels, vec3 position) { return false; }
