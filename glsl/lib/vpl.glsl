#ifndef VPL_GLSL
#define VPL_GLSL
// Position and normal of a virtual point light. Its radiant intensity along the normal is in a separate buffer.
struct VplPlace {
    vec3 position;
    uint normal; // octahedral_snorm16
};
#endif
