#ifndef SKY_FRAME_GLSL
#define SKY_FRAME_GLSL
// Frame of a direction's orthographic map: vectors of which the dot products with the vector from the VPL are the place in [-1, 1]^2.
struct SkyFrame {
    vec3 right;
    float scale;  // mean length of the vectors, 1/m
    vec3 up;
    float extent; // 1 / (scale * far)
};
#endif
