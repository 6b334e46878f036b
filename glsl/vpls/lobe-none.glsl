// VPLs without lobes. Each part for "lobe" defines
//     bool put_lobe(uint index, ivec3 at, float texels, vec3 position);
// which stores the glossy VPL beside a diffuse one, and returns whether it has light; layer -1 is a texel without a surface.
bool put_lobe(uint index, ivec3 at, float texels, vec3 position) { return false; }
