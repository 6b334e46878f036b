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

float mask_texel(TexelMap map, float x, float y) { return texelFetch(mask_texels, texel_place(map, vec2(x, y)), 0).r; }

float mask_at(TexelMap map, vec2 p) {
    if (map.size == 0u) return 1.0;
    TexelQuad q = texels_at(map, p);
    float above = mix(mask_texel(map, q.first.x, q.first.y), mask_texel(map, q.last.x, q.first.y), q.part.x);
    float below = mix(mask_texel(map, q.first.x, q.last.y), mask_texel(map, q.last.x, q.last.y), q.part.x);
    return mix(above, below, q.part.y);
}

bool is_masked(uint material) { return masks.at[material].cutoff > 0.0; }

// Whether the surface of a masked material is a hole at these weights of a triangle's corners.
bool lacks(uint material, uvec3 corners, vec3 weights) {
    PointMask mask = masks.at[material];
    vec3 at = mat3(mask_corners.at[corners.x], mask_corners.at[corners.y], mask_corners.at[corners.z]) * weights;
    TexelMap map = TexelMap(mask.first, mask.size, mask.how);
    return mask.alpha * at.z * mask_at(map, mask.matrix * at.xy + mask.offset) < mask.cutoff;
}
