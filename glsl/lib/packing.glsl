#ifndef PACKING_GLSL
#define PACKING_GLSL
// Octahedral mapping of unit vectors (Cigolle et al. 2014), and the packings of src/scene/pack.rs.
#include "lib/exact.glsl"

vec2 sign_not_zero(vec2 v) { return vec2(v.x >= 0.0 ? 1.0 : -1.0, v.y >= 0.0 ? 1.0 : -1.0); }

// Unit vector to [-1, 1]^2.
vec2 octahedral(vec3 v) {
    vec2 p = v.xy / (abs(v.x) + abs(v.y) + abs(v.z));
    return v.z >= 0.0 ? p : (1.0 - abs(p.yx)) * sign_not_zero(p);
}

// [-1, 1]^2 to the unit vector.
EXACT vec3 octahedral_inverse(vec2 p) {
    float z = 1.0 - abs(p.x) - abs(p.y);
    vec2 xy = z >= 0.0 ? p : (1.0 - abs(p.yx)) * sign_not_zero(p);
    return normalize(vec3(xy, z));
}

// Two signed normalized 16-bit numbers in a word, x low.
uint octahedral_snorm16(vec3 v) { return packSnorm2x16(octahedral(v)); }
vec3 octahedral_snorm16_inverse(uint word) { return octahedral_inverse(unpackSnorm2x16(word)); }

// Tangent (xyz) and handedness (w) of pack::tangent.
vec4 tangent_inverse(uint word) {
    vec2 p = vec2(word & 0x7fffu, (word >> 15) & 0x7fffu) / 32767.0 * 2.0 - 1.0;
    return vec4(octahedral_inverse(p), (word >> 31) != 0u ? -1.0 : 1.0);
}

// Packed direction of a tangent, whose handedness is positive; it need not be of unit length.
uint packed_tangent(vec3 v) {
    uvec2 p = uvec2(round((octahedral(v) * 0.5 + 0.5) * 32767.0));
    return p.x | p.y << 15;
}
#endif
