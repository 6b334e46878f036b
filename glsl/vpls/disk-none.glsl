// VPLs without disks. Each part for "disk" defines
//     void put_disk(uint index, vec2 areas);
// which stores the area of a VPL's texel across the map's axis, and of all texels that the VPL stands for, m^2; 0 without light.
void put_disk(uint index, vec2 areas) {}
