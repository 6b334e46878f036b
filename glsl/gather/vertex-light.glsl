// A vertex's proxy light, interpolated from those of caches.
struct VertexLight {
    vec3 way;     // from the vertex to its place
    float extent; // metres
    vec3 flux;    // W
};
