// VPLs with the area of their texel.
layout(scalar) writeonly buffer Disks { float at[]; } disks;

void put_disk(uint index, float area) { disks.at[index] = area; }
