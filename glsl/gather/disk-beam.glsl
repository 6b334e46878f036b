// VALs that each stand for their own beam. Each part for "disk" defines
//     vec2 disk_of(uint i);
// the area A_disk of VAL i (equation 1), and that of all texels that it stands for, m^2; 0 without light.
layout(scalar) readonly buffer Areas { float at[]; } areas; // across the beam

vec2 disk_of(uint i) { return vec2(areas.at[i]); }
