// VALs that each stand for their own beam. Each part for "disk" defines
//     vec2 disk_of(uint i, float beam);
// the area A_disk of VAL i (equation 1), and that of all texels that it stands for, m^2; `beam` is the latter across the beam.
vec2 disk_of(uint i, float beam) { return vec2(beam); }
