// VALs with the area of their texel.
layout(scalar) readonly buffer Disks { vec2 at[]; } disks;

vec2 disk_of(uint i) { return disks.at[i]; }
