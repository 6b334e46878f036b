// VPLs without disks. Each part for "disk" defines
//     void put_disk(uint index, float area);
// which stores the area of a VPL's texel across the beam, m^2.
void put_disk(uint index, float area) {}
