// VPLs with the area of their texel.
layout(scalar) writeonly buffer Disks { vec2 at[]; } disks;

void put_disk(uint index, vec2 areas) { disks.at[index] = areas; }
