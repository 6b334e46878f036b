// VALs with the area of their texel.
layout(scalar) readonly buffer Disks { float at[]; } disks;

float disk_of(uint i, float beam) { return disks.at[i]; }
