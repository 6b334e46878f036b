#ifndef COLOR_GLSL
#define COLOR_GLSL
// Transfer curves between radiance and screen.
#include "lib/exact.glsl"

// Largest 16-bit float; brighter values are stored as this, not as infinity.
const float LARGEST_HALF = 65504.0;

// Linear to sRGB-encoded, both in [0, 1].
vec3 linear_to_srgb(vec3 c) {
    return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, greaterThan(c, vec3(0.0031308)));
}

vec3 srgb_to_linear(vec3 c) {
    return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

EXACT float luminance(vec3 c) { return exact_dot(c, vec3(0.2126, 0.7152, 0.0722)); }

// Reinhard's operator on luminance, which keeps hues.
vec3 reinhard(vec3 c) { return c / (1.0 + luminance(c)); }
#endif
