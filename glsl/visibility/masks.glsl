// Alpha masks at points, as rays see them (glsl/bvh/hole.glsl): by the finest mip, whatever the point's size. A point stands for the surface
// around it, holes included, so that the points that are left stand for the surface that is left.
#include "lib/texels.glsl"

// Bindings of src/world/masks.rs.
struct PointMask {
    mat2 matrix; // of texture coordinates
    vec2 offset;
    float alpha;  // factor
    float cutoff; // 0 where a material has no mask
    uint first;   // the rest is a TexelMap
    uint size;
    uint how;
};

layout(scalar) readonly buffer Masks { PointMask at[]; } masks;
layout(scalar) readonly buffer MaskCorners { vec3 at[]; } mask_corners; // texture coordinates and alpha of each vertex
uniform sampler2DArray mask_texels;

float mask_texel(TexelMap map, vec2 at) {
    uint i = map.first + uint(at.y) * (map.size & 0xffffu) + uint(at.x);
    return texelFetch(mask_texels, ivec3(i & 4095u, (i >> 12) & 4095u, i >> 24), 0).r;
}

float mask_at(TexelMap map, vec2 p) {
    if (map.size == 0u) return 1.0;
    vec2 size = vec2(map.size & 0xffffu, map.size >> 16);
    uint across = map.how & 3u, down = (map.how >> 2) & 3u;
    p = vec2(wrapped(p.x, across), wrapped(p.y, down)) * size;
    if ((map.how & NEAREST_TEXEL) != 0u) return mask_texel(map, min(floor(p), size - 1.0));
    p -= 0.5;
    vec2 low = floor(p), part = p - low;
    vec2 a = vec2(neighbour(low.x, size.x, across), neighbour(low.y, size.y, down));
    vec2 b = vec2(neighbour(low.x + 1.0, size.x, across), neighbour(low.y + 1.0, size.y, down));
    float above = mix(mask_texel(map, a), mask_texel(map, vec2(b.x, a.y)), part.x);
    float below = mix(mask_texel(map, vec2(a.x, b.y)), mask_texel(map, b), part.x);
    return mix(above, below, part.y);
}

bool is_masked(uint material) { return masks.at[material].cutoff > 0.0; }

// Whether the surface of a masked material is a hole at these weights of a triangle's corners.
bool lacks(uint material, uvec3 corners, vec3 weights) {
    PointMask mask = masks.at[material];
    vec3 at = mat3(mask_corners.at[corners.x], mask_corners.at[corners.y], mask_corners.at[corners.z]) * weights;
    TexelMap map = TexelMap(mask.first, mask.size, mask.how);
    return mask.alpha * at.z * mask_at(map, mask.matrix * at.xy + mask.offset) < mask.cutoff;
}
