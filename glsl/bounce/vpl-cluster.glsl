// A cluster of VPLs: the place that its map is rendered from and that its light is bounced on from.
struct VplCluster {
    vec3 position;
    uint normal;  // octahedral_snorm16
    vec3 flux;    // that its VPLs reflect, W; each by the share that stays in the scene, over that of the place
    uint members;
    float spread; // mean square of their distance from the cluster's mean, m^2
};

const uint MOST_CLUSTERS = 64u;
const uint NO_CLUSTER = 0xffffffffu; // of VPLs without light
