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

// Place of a map's texel in the image.
ivec3 texel_place(TexelMap map, vec2 at) {
    uint i = map.first + uint(at.y) * (map.size & 0xffffu) + uint(at.x);
    return ivec3(i & 4095u, (i >> 12) & 4095u, i >> 24);
}

// Four texels around a place, bilinear: the upper left one, the lower right one, and the weight of right and lower. Where the map is not
// filtered, all are the nearest one.
struct TexelQuad {
    vec2 first;
    vec2 last;
    vec2 part;
};

// Texels of a map that is there, at texture coordinates.
TexelQuad texels_at(TexelMap map, vec2 p) {
    vec2 size = vec2(map.size & 0xffffu, map.size >> 16);
    uint across = map.how & 3u, down = (map.how >> 2) & 3u;
    p = vec2(wrapped(p.x, across), wrapped(p.y, down)) * size;
    if ((map.how & NEAREST_TEXEL) != 0u) {
        p = min(floor(p), size - 1.0);
        return TexelQuad(p, p, vec2(0.0));
    }
    p -= 0.5;
    vec2 low = floor(p);
    return TexelQuad(vec2(neighbour(low.x, size.x, across), neighbour(low.y, size.y, down)),
                     vec2(neighbour(low.x + 1.0, size.x, across), neighbour(low.y + 1.0, size.y, down)), p - low);
}
#endif
