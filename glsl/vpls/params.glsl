#ifndef VPLS_PARAMS_GLSL
#define VPLS_PARAMS_GLSL
// What the samplers of reflective shadow maps are told; src/stages/vpls/points.rs fills in the points.
layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    uvec2 size;   // texels of a map
    uint lights;  // maps
    uint count;   // VPLs
    vec4 shift;   // rotation of point sets modulo 1
    uvec4 bases;  // of Halton points
    uint start;   // of Halton points
    uint seed;
} params;
#endif
