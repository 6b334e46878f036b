// What a ray meets: surfaces with their materials, through holes and, for the camera, through the backs of single-sided ones.
#define SURFACE_GLSL
#include "bvh/traverse.glsl"
#include "lib/color.glsl"
#include "lib/packing.glsl"
#include "lib/scene.glsl"

// What some material of the scene has; what none has costs nothing.
layout(constant_id = 100) const bool BASE_COLOR_MAPS = true;
layout(constant_id = 101) const bool METALLIC_ROUGHNESS_MAPS = true;
layout(constant_id = 102) const bool EMISSION_MAPS = true;
layout(constant_id = 103) const bool NORMAL_MAPS = true;
layout(constant_id = 104) const bool VERTEX_COLORS = true;
layout(constant_id = 106) const bool EMISSION = true;
layout(constant_id = 107) const bool METALS = true;

// The reflection cannot evaluate what is made of these constants by an operator: functions hide it from there.
bool without(bool some) { return !some; }
bool either(bool one, bool other) { return one || other; }

layout(scalar) readonly buffer Vertices { Vertex at[]; } vertices;
layout(scalar) readonly buffer Indices { uint at[]; } indices;
layout(scalar) readonly buffer Draws { DrawData at[]; } draws;
layout(scalar) readonly buffer Materials { Material at[]; } materials;
uniform usampler2D bvh_masks;
uniform sampler2DArray texels; // of all textures, one after the other

struct Surface {
    vec3 position;
    vec3 geometric_normal; // turned to where the ray came from
    vec3 normal;           // for shading; turned by the same sign, which may leave it facing away at grazing angles
    vec3 albedo;           // base colour
    float metallic;
    float roughness;
    vec3 emission;         // radiance towards where the ray came from
    float emitter_density;
    bool front;
    bool double_sided;
};

vec4 texel(TexelMap map, vec2 at) {
    uint i = map.first + uint(at.y) * (map.size & 0xffffu) + uint(at.x);
    return texelFetch(texels, ivec3(i & 4095u, (i >> 12) & 4095u, i >> 24), 0);
}

vec4 decoded(TexelMap map, vec2 at) {
    vec4 t = texel(map, at);
    return (map.how & SRGB_TEXELS) != 0u ? vec4(srgb_to_linear(t.rgb), t.a) : t;
}

// A coordinate, brought into [0, 1].
float wrapped(float u, uint wrap) {
    float repeated = u - floor(u);
    float mirrored = 1.0 - abs(fract(u * 0.5) * 2.0 - 1.0);
    return wrap == WRAP_REPEAT ? repeated : wrap == WRAP_MIRRORED ? mirrored : clamp(u, 0.0, 1.0);
}

// A texel's number beside the edge: on the other side where the texture repeats, else the edge's.
float neighbour(float i, float size, uint wrap) {
    if (wrap == WRAP_REPEAT) i += i < 0.0 ? size : i >= size ? -size : 0.0;
    return clamp(i, 0.0, size - 1.0);
}

// A texture where the rasterizer would look it up, from the finest mip: sharper than that, and as sharp from everywhere.
vec4 look_up_at(TexelMap map, vec2 p) {
    if (map.size == 0u) return vec4(1.0);
    vec2 size = vec2(map.size & 0xffffu, map.size >> 16);
    uint across = map.how & 3u, down = (map.how >> 2) & 3u;
    p = vec2(wrapped(p.x, across), wrapped(p.y, down)) * size;
    if ((map.how & NEAREST_TEXEL) != 0u) return decoded(map, min(floor(p), size - 1.0));
    p -= 0.5;
    vec2 low = floor(p), part = p - low;
    vec2 a = vec2(neighbour(low.x, size.x, across), neighbour(low.y, size.y, down));
    vec2 b = vec2(neighbour(low.x + 1.0, size.x, across), neighbour(low.y + 1.0, size.y, down));
    vec4 above = mix(decoded(map, a), decoded(map, vec2(b.x, a.y)), part.x);
    vec4 below = mix(decoded(map, vec2(a.x, b.y)), decoded(map, b), part.x);
    return mix(above, below, part.y);
}

vec4 look_up(TexelMap map, MapUse use, vec2 uv) { return look_up_at(map, use.matrix * uv + use.offset); }

struct Corners {
    uvec3 vertex;
    uint draw;
    uint material;
};

Corners corners_of(uvec4 first, uvec4 second) {
    Corners corners;
    corners.draw = first.w;
    corners.material = draws.at[first.w].material;
    uint offset = draws.at[first.w].vertex_offset;
    corners.vertex = offset + uvec3(indices.at[second.w], indices.at[second.w + 1u], indices.at[second.w + 2u]);
    return corners;
}

vec2 uv_at(Corners corners, vec3 weights) {
    return weights.x * vertices.at[corners.vertex.x].uv + weights.y * vertices.at[corners.vertex.y].uv + weights.z * vertices.at[corners.vertex.z].uv;
}

vec4 color_at(Corners corners, vec3 weights) {
    return weights.x * unpackUnorm4x8(vertices.at[corners.vertex.x].color) + weights.y * unpackUnorm4x8(vertices.at[corners.vertex.y].color)
         + weights.z * unpackUnorm4x8(vertices.at[corners.vertex.z].color);
}

bool is_hole(uint mask, vec2 barycentric) {
    // See src/scene/bvh.rs.
    uint i = 3u * mask;
    uvec4 a = texelFetch(bvh_masks, ivec2(i & 4095u, i >> 12), 0);
    uvec4 b = texelFetch(bvh_masks, ivec2((i + 1u) & 4095u, (i + 1u) >> 12), 0);
    uvec4 c = texelFetch(bvh_masks, ivec2((i + 2u) & 4095u, (i + 2u) >> 12), 0);
    vec3 weights = vec3(1.0 - barycentric.x - barycentric.y, barycentric);
    vec2 place = weights.x * uintBitsToFloat(a.xy) + weights.y * uintBitsToFloat(a.zw) + weights.z * uintBitsToFloat(b.xy);
    float alpha = uintBitsToFloat(c.y);
    if (VERTEX_COLORS) alpha *= dot(weights, unpackUnorm4x8(c.z).xyz);
    // Alpha has no curve.
    if (BASE_COLOR_MAPS) alpha *= look_up_at(TexelMap(b.z, b.w, c.x & ~SRGB_TEXELS), place).a;
    return alpha < uintBitsToFloat(c.w);
}

// The nearest surface from t_min on.
Hit nearest(Ray ray, float t_min, bool from_camera) { return traverse(ray, t_min, 1e30, false, from_camera); }

// Whether a surface lies on a ray before t_max.
bool is_occluded(Ray ray, float t_max) { return traverse(ray, 0.0, t_max, true, false).triangle != NO_TRIANGLE; }

// Radiance that a material emits at a place of its textures.
vec3 emission_at(uint material, vec2 uv) {
    vec3 emission = materials.at[material].emission;
    if (EMISSION_MAPS) emission *= look_up(materials.at[material].emission_texels, materials.at[material].emission_map, uv).rgb;
    return emission;
}

// All of a hit.
Surface surface_at(Ray ray, Hit hit) {
    uvec4 ta = triangle_texel(3u * hit.triangle), tb = triangle_texel(3u * hit.triangle + 1u), tc = triangle_texel(3u * hit.triangle + 2u);
    Corners corners = corners_of(ta, tb);
    vec3 weights = vec3(1.0 - hit.weights.x - hit.weights.y, hit.weights);
    vec3 a = uintBitsToFloat(ta.xyz), b = uintBitsToFloat(tb.xyz), c = uintBitsToFloat(tc.xyz);
    Surface s;
    s.position = weights.x * a + weights.y * b + weights.z * c;
    vec3 face = cross(b - a, c - a);
    s.front = dot(face, ray.direction) < 0.0;
    float side = s.front ? 1.0 : -1.0;
    s.geometric_normal = normalize(face) * side;

    mat4x3 transform = draws.at[corners.draw].transform;
    mat3 linear = mat3(transform);
    mat3 cofactor = mat3(cross(linear[1], linear[2]), cross(linear[2], linear[0]), cross(linear[0], linear[1]));
    float orientation = dot(linear[0], cofactor[0]) < 0.0 ? -1.0 : 1.0;
    vec3 n = weights.x * (cofactor * octahedral_snorm16_inverse(vertices.at[corners.vertex.x].normal))
           + weights.y * (cofactor * octahedral_snorm16_inverse(vertices.at[corners.vertex.y].normal))
           + weights.z * (cofactor * octahedral_snorm16_inverse(vertices.at[corners.vertex.z].normal));
    n = dot(n, n) > 0.0 ? normalize(n) * orientation : normalize(face);

    uint m = corners.material;
    vec2 uv = vec2(0.0);
    if (either(either(BASE_COLOR_MAPS, METALLIC_ROUGHNESS_MAPS), either(EMISSION_MAPS, NORMAL_MAPS))) uv = uv_at(corners, weights);
    if (NORMAL_MAPS && materials.at[m].normal_texels.size != 0u) {
        vec4 t0 = tangent_inverse(vertices.at[corners.vertex.x].tangent);
        vec3 t = linear * (weights.x * t0.xyz + weights.y * tangent_inverse(vertices.at[corners.vertex.y].tangent).xyz
                         + weights.z * tangent_inverse(vertices.at[corners.vertex.z].tangent).xyz);
        t -= n * dot(n, t);
        float squared = dot(t, t);
        if (squared > 0.0) {
            t *= inversesqrt(squared);
            vec3 bitangent = cross(n, t) * t0.w;
            vec3 map = look_up(materials.at[m].normal_texels, materials.at[m].normal_map, uv).xyz * 2.0 - 1.0;
            float scale = materials.at[m].normal_scale;
            n = normalize(map.x * scale * t + map.y * scale * bitangent + map.z * n);
        }
    }
    s.normal = n * side;

    s.albedo = materials.at[m].base_color.rgb;
    if (VERTEX_COLORS) s.albedo *= color_at(corners, weights).rgb;
    if (BASE_COLOR_MAPS) s.albedo *= look_up(materials.at[m].base_color_texels, materials.at[m].base_color_map, uv).rgb;
    s.metallic = 0.0;
    if (METALS) s.metallic = materials.at[m].metallic;
    s.roughness = materials.at[m].roughness;
    if (METALLIC_ROUGHNESS_MAPS) {
        vec2 mr = look_up(materials.at[m].metallic_roughness_texels, materials.at[m].metallic_roughness_map, uv).bg;
        s.metallic *= mr.x;
        s.roughness *= mr.y;
    }
    s.double_sided = (tc.w & SINGLE_SIDED) == 0u;
    s.emission = vec3(0.0);
    s.emitter_density = 0.0;
    if (EMISSION && (s.front || s.double_sided)) {
        s.emission = emission_at(m, uv);
        s.emitter_density = materials.at[m].emitter_density;
    }
    return s;
}

// A point just off a surface, on the side of its normal, so that a ray from there does not meet it again (Wächter and Binder 2019):
// by so many steps of the floats that the coordinates are.
vec3 off_surface(vec3 position, vec3 normal) {
    ivec3 steps = ivec3(256.0 * normal);
    vec3 moved = intBitsToFloat(floatBitsToInt(position) + mix(steps, -steps, lessThan(position, vec3(0.0))));
    return mix(moved, position + normal / 65536.0, lessThan(abs(position), vec3(1.0 / 32.0)));
}
