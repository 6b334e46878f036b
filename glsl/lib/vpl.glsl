#ifndef VPL_GLSL
#define VPL_GLSL
// Where a virtual point light is. Its radiant intensity along the normal lies in a buffer of its own.
struct VplPlace {
    vec3 position;
    uint normal; // octahedral_snorm16
};
#endif
