#ifndef TEXELS_GLSL
#define TEXELS_GLSL
// Maps in an image of all textures' texels: src/world/traced.rs and src/world/masks.rs.

// Location of a map's texels.
struct TexelMap {
    uint first;
    uint size; // width, and height in the upper half; 0 where there is no map
    uint how;  // wrapping across in bits 0 and 1, down in bits 2 and 3; the bits below
};

const uint WRAP_REPEAT = 0u;
const uint WRAP_MIRRORED = 1u;
const uint WRAP_CLAMP = 2u;
const uint NEAREST_TEXEL = 16u;
const uint SRGB_TEXELS = 32u;

// Texture coordinate wrapped into [0, 1].
float wrapped(float u, uint wrap) {
    float repeated = u - floor(u);
    float mirrored = 1.0 - abs(fract(u * 0.5) * 2.0 - 1.0);
    return wrap == WRAP_REPEAT ? repeated : wrap == WRAP_MIRRORED ? mirrored : clamp(u, 0.0, 1.0);
}

// Texel index beyond an edge: the other side's if the texture repeats, else the edge's.
float neighbour(float i, float size, uint wrap) {
    if (wrap == WRAP_REPEAT) i += i < 0.0 ? size : i >= size ? -size : 0.0;
    return clamp(i, 0.0, size - 1.0);
}
#endif
