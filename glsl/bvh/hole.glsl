// Rays through a scene with alpha-masked surfaces.
#include "bvh/traverse.glsl"
#include "lib/color.glsl"
#include "lib/packing.glsl"
#include "lib/texels.glsl"

// Features that any material of the scene has; absent features are compiled out.
layout(constant_id = 100) const bool BASE_COLOR_MAPS = true;
layout(constant_id = 104) const bool VERTEX_COLORS = true;

// Bindings of src/world/bvh.rs and src/world/traced.rs.
uniform usampler2D bvh_masks;
uniform sampler2DArray texels; // texels of all textures, one after the other

vec4 texel(TexelMap map, vec2 at) { return texelFetch(texels, texel_place(map, at), 0); }

vec4 decoded(TexelMap map, vec2 at) {
    vec4 t = texel(map, at);
    return (map.how & SRGB_TEXELS) != 0u ? vec4(srgb_to_linear(t.rgb), t.a) : t;
}

// Texture lookup with the rasterizer's coordinates, in the finest mip: sharper than the rasterizer's, and independent of the view.
vec4 look_up_at(TexelMap map, vec2 p) {
    if (map.size == 0u) return vec4(1.0);
    TexelQuad q = texels_at(map, p);
    vec4 above = mix(decoded(map, q.first), decoded(map, vec2(q.last.x, q.first.y)), q.part.x);
    vec4 below = mix(decoded(map, vec2(q.first.x, q.last.y)), decoded(map, q.last), q.part.x);
    return mix(above, below, q.part.y);
}

bool is_hole(uint mask, vec2 barycentric) {
    // The layout is `Mask` of src/world/bvh.rs.
    uint i = 3u * mask;
    uvec4 a = texelFetch(bvh_masks, ivec2(i & 4095u, i >> 12), 0);
    uvec4 b = texelFetch(bvh_masks, ivec2((i + 1u) & 4095u, (i + 1u) >> 12), 0);
    uvec4 c = texelFetch(bvh_masks, ivec2((i + 2u) & 4095u, (i + 2u) >> 12), 0);
    vec3 weights = vec3(1.0 - barycentric.x - barycentric.y, barycentric);
    vec2 place = weights.x * uintBitsToFloat(a.xy) + weights.y * uintBitsToFloat(a.zw) + weights.z * uintBitsToFloat(b.xy);
    float alpha = uintBitsToFloat(c.y);
    if (VERTEX_COLORS) alpha *= dot(weights, unpackUnorm4x8(c.z).xyz);
    // Alpha is linear.
    if (BASE_COLOR_MAPS) alpha *= look_up_at(TexelMap(b.z, b.w, c.x & ~SRGB_TEXELS), place).a;
    return alpha < uintBitsToFloat(c.w);
}

// Nearest hit from t_min on.
Hit nearest(Ray ray, float t_min, bool from_camera) { return traverse(ray, 0u, t_min, 1e30, false, from_camera); }

// Whether there is a hit before t_max.
bool is_occluded(Ray ray, float t_max) { return traverse(ray, 0u, 0.0, t_max, true, false).triangle != NO_TRIANGLE; }

// Position moved off a surface along its normal by a number of float steps, so that a ray from there does not hit the surface again
// (Wächter and Binder 2019).
vec3 off_surface(vec3 position, vec3 normal) {
    ivec3 steps = ivec3(256.0 * normal);
    vec3 moved = intBitsToFloat(floatBitsToInt(position) + mix(steps, -steps, lessThan(position, vec3(0.0))));
    return mix(moved, position + normal / 65536.0, lessThan(abs(position), vec3(1.0 / 32.0)));
}
