// VALs that each stand for their own beam. Each part for "disk" defines
//     float disk_of(uint i, float beam);
// the area A_disk of VAL i across its beam (equation 1), m^2; `beam` is that of all texels that the VAL stands for.
float disk_of(uint i, float beam) { return beam; }
