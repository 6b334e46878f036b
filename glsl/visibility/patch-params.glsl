// Push constants of the passes that tessellate: src/stages/visibility/points.rs.
layout(scalar, push_constant) uniform Params {
    float max_area; // of a small triangle, m^2
    float diagonal; // of the scene's bounds, metres
    uint partitions;
    uint capacity;  // points of a partition
    uint seed;
} params;
