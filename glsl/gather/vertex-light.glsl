// A vertex's proxy light, interpolated from those of caches.
struct VertexLight {
    vec3 way;     // from the vertex to its place, times `lit`
    float extent; // metres, times `lit`
    vec3 flux;    // W; mean of all caches
    float lit;    // share of the weights that lit caches have: dark ones have no place
};
