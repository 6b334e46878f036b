#ifndef VERTEX_GLSL
#define VERTEX_GLSL
// A vertex in the layout of src/scene/mod.rs.
struct Vertex {
    vec3 position;
    uint normal; // octahedral_snorm16
    vec2 uv;
    uint color;
    uint tangent; // pack::tangent
};
#endif
