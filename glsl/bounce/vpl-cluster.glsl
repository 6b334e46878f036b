// A VPL cluster: the representative, from which its map is rendered and its light goes on, and the flux of its VPLs.
struct VplCluster {
    vec3 position;
    uint normal;  // octahedral_snorm16
    vec3 flux;    // reflected flux of its VPLs, W: the sum of flux_i * kept_i / kept_representative
    uint members;
    float spread; // mean squared distance of members from the cluster's mean, m^2
};

const uint MOST_CLUSTERS = 64u;
const uint NO_CLUSTER = 0xffffffffu; // label of VPLs without light
