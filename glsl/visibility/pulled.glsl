// Texel of a coarser level: two words.
#include "visibility/ism.glsl"

struct Pulled {
    float depth;  // over `far`
    float radius; // texels of the finest level
    float extent; // length of the depth interval, over `far`
    vec2 offset;  // position from the texel's centre, in texels of its level
    vec2 tilt;    // if normals are kept
};

// Largest offset of a position from its texel's centre, texels.
const float FARTHEST_OFFSET = 8.0;

// Weight of a point at an offset from a texel's centre, in texels of the coarser of two levels: a Gaussian of half a texel (after Marroquim et
// al. 2008).
float gaussian_weight(vec2 offset) { return exp(-2.0 * min(dot(offset, offset), 30.0)); }

uvec2 pack_pulled(Pulled p) {
    uint offset = packSnorm4x8(vec4(p.offset / FARTHEST_OFFSET, 0.0, 0.0)) & 0xffffu;
    return uvec2(pack_pixel(p.depth, p.radius), packHalf2x16(vec2(p.extent, 0.0)) << 16 | offset);
}

Pulled unpack_pulled(uvec2 words) {
    return Pulled(pixel_depth(words.x), pixel_radius(words.x), unpackHalf2x16(words.y >> 16).x, unpackSnorm4x8(words.y & 0xffffu).xy * FARTHEST_OFFSET,
                  vec2(0.0));
}
