// A virtual point light: where it is; its radiant intensity along the normal lies in a buffer of its own.
struct VplPoint {
    vec3 position;
    uint normal; // octahedral_snorm16
};

// The least cosine to the beam that makes a VPL which stands for the area of it: grazing beams light strips, no disks.
const float LEAST_COSINE = 0.1;
