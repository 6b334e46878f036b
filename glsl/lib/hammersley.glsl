#ifndef HAMMERSLEY_GLSL
#define HAMMERSLEY_GLSL
// Point k of the n-point Hammersley set (Wong et al. 1997) in [0, 1)^2, shifted by half a step along the first axis.
vec2 hammersley(uint k, uint n) { return vec2((float(k) + 0.5) / float(n), float(bitfieldReverse(k) >> 8u) / 16777216.0); }
#endif
