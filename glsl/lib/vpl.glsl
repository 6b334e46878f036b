#ifndef VPL_GLSL
#define VPL_GLSL
// A virtual point light: where it is; its radiant intensity along the normal lies in a buffer of its own.
struct VplPoint {
    vec3 position;
    uint normal; // octahedral_snorm16
};
#endif
