// A VPL cluster: the place of its representative, from which its map is rendered and its light sent on.
struct VplCluster {
    vec3 position;
    uint normal;  // octahedral_snorm16
    vec3 flux;    // of its VPLs, W: the sum of flux_i * kept_i / kept_representative; kept = share that stays in the scene, 1 if unknown
    uint members;
    float spread; // mean square of their distance from the cluster's mean, m^2
};

const uint MOST_CLUSTERS = 64u;
const uint NO_CLUSTER = 0xffffffffu; // of VPLs without light
