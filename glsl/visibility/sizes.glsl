// Size of points: src/stages/visibility/density.rs.
layout(scalar) uniform Sizes {
    float max_area; // of a small triangle, m^2
} sizes;
