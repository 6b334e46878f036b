// Surfaces at hits, with their materials.
#include "bvh/hole.glsl"

layout(constant_id = 101) const bool METALLIC_ROUGHNESS_MAPS = true;
layout(constant_id = 102) const bool EMISSION_MAPS = true;
layout(constant_id = 103) const bool NORMAL_MAPS = true;
layout(constant_id = 106) const bool EMISSION = true;
layout(constant_id = 107) const bool METALS = true;

// The reflection of shaders cannot evaluate expressions of these constants; functions hide them from it.
bool without(bool some) { return !some; }
bool either(bool one, bool other) { return one || other; }

uniform usampler2D bvh_corners;
uniform usampler2D bvh_colors;
uniform usampler2D materials;

// Indices of a material's maps.
const uint BASE_COLOR = 0u;
const uint METALLIC_ROUGHNESS = 1u;
const uint EMITTED = 2u;
const uint NORMAL = 3u;

vec4 material_numbers(uint material, uint i) {
    uint at = material * 16u + i;
    return uintBitsToFloat(texelFetch(materials, ivec2(at & 4095u, at >> 12), 0));
}

struct Surface {
    vec3 position;
    vec3 geometric_normal; // flipped to face the ray's origin
    vec3 normal;           // shading normal; flipped by the same sign, so it may face away at grazing angles
    vec3 albedo;           // base colour
    float metallic;
    float roughness;
    vec3 emission;         // radiance towards the ray's origin
    float emitter_density;
    bool front;
    bool double_sided;
    float reach;           // largest coordinate of its triangle, to which the position's rounding error is relative
};

// Lookup of a material's map; white if there is none.
vec4 look_up(uint material, uint which, vec2 uv) {
    vec4 matrix = material_numbers(material, 3u + 3u * which), place = material_numbers(material, 4u + 3u * which);
    TexelMap map = TexelMap(floatBitsToUint(place.z), floatBitsToUint(place.w), floatBitsToUint(material_numbers(material, 5u + 3u * which).x));
    return look_up_at(map, mat2(matrix.xy, matrix.zw) * uv + place.xy);
}

uvec4 corner_texel(uint i) { return texelFetch(bvh_corners, ivec2(i & 4095u, i >> 12), 0); }

// Emitted radiance of a material at texture coordinates.
vec3 emission_at(uint material, vec2 uv) {
    vec3 emission = material_numbers(material, 1u).rgb;
    if (EMISSION_MAPS) emission *= look_up(material, EMITTED, uv).rgb;
    return emission;
}

// Emission of a hit towards the ray's origin.
struct Shine {
    vec3 emission;         // radiance
    float emitter_density; // density by which the point is sampled as a light, 1/m^2
    float cosine;          // cosine between ray and geometric normal
};

Shine shine_at(Ray ray, Hit hit) {
    uvec4 ta = triangle_texel(3u * hit.triangle), tb = triangle_texel(3u * hit.triangle + 1u), tc = triangle_texel(3u * hit.triangle + 2u);
    vec3 a = uintBitsToFloat(ta.xyz), face = cross(uintBitsToFloat(tb.xyz) - a, uintBitsToFloat(tc.xyz) - a);
    float cosine = -dot(normalize(face), normalize(ray.direction));
    if (cosine < 0.0 && (tc.w & SINGLE_SIDED) != 0u) return Shine(vec3(0.0), 0.0, 0.0);
    vec2 uv = vec2(0.0);
    if (EMISSION_MAPS) {
        uvec4 ca = corner_texel(3u * hit.triangle), cb = corner_texel(3u * hit.triangle + 1u), cc = corner_texel(3u * hit.triangle + 2u);
        uv = (1.0 - hit.weights.x - hit.weights.y) * uintBitsToFloat(ca.yz) + hit.weights.x * uintBitsToFloat(cb.yz) + hit.weights.y * uintBitsToFloat(cc.yz);
    }
    return Shine(emission_at(ta.w, uv), material_numbers(ta.w, 1u).w, abs(cosine));
}

// Full surface at a hit.
Surface surface_at(Ray ray, Hit hit) {
    uvec4 ta = triangle_texel(3u * hit.triangle), tb = triangle_texel(3u * hit.triangle + 1u), tc = triangle_texel(3u * hit.triangle + 2u);
    uvec4 ca = corner_texel(3u * hit.triangle), cb = corner_texel(3u * hit.triangle + 1u), cc = corner_texel(3u * hit.triangle + 2u);
    vec3 weights = vec3(1.0 - hit.weights.x - hit.weights.y, hit.weights);
    vec3 a = uintBitsToFloat(ta.xyz), b = uintBitsToFloat(tb.xyz), c = uintBitsToFloat(tc.xyz);
    uint material = ta.w;
    Surface s;
    s.position = weights.x * a + weights.y * b + weights.z * c;
    vec3 most = max(abs(a), max(abs(b), abs(c)));
    s.reach = max(most.x, max(most.y, most.z));
    vec3 face = cross(b - a, c - a);
    s.front = dot(face, ray.direction) < 0.0;
    float side = s.front ? 1.0 : -1.0;
    s.geometric_normal = normalize(face) * side;

    vec3 n = weights.x * octahedral_snorm16_inverse(ca.x) + weights.y * octahedral_snorm16_inverse(cb.x)
           + weights.z * octahedral_snorm16_inverse(cc.x);
    n = dot(n, n) > 0.0 ? normalize(n) : normalize(face);
    vec2 uv = weights.x * uintBitsToFloat(ca.yz) + weights.y * uintBitsToFloat(cb.yz) + weights.z * uintBitsToFloat(cc.yz);
    vec4 further = material_numbers(material, 2u);
    if (NORMAL_MAPS) {
        vec4 t0 = tangent_inverse(ca.w);
        vec3 t = weights.x * t0.xyz + weights.y * tangent_inverse(cb.w).xyz + weights.z * tangent_inverse(cc.w).xyz;
        t -= n * dot(n, t);
        float squared = dot(t, t);
        vec3 map = look_up(material, NORMAL, uv).xyz * 2.0 - 1.0;
        // White means that there is no map.
        if (squared > 0.0 && any(lessThan(map, vec3(1.0)))) {
            t *= inversesqrt(squared);
            vec3 bitangent = cross(n, t) * t0.w;
            n = normalize(map.x * further.y * t + map.y * further.y * bitangent + map.z * n);
        }
    }
    s.normal = n * side;

    vec4 base = material_numbers(material, 0u);
    s.albedo = base.rgb;
    if (VERTEX_COLORS) {
        uvec3 colors = texelFetch(bvh_colors, ivec2(hit.triangle & 4095u, hit.triangle >> 12), 0).xyz;
        s.albedo *= weights.x * unpackUnorm4x8(colors.x).rgb + weights.y * unpackUnorm4x8(colors.y).rgb + weights.z * unpackUnorm4x8(colors.z).rgb;
    }
    if (BASE_COLOR_MAPS) s.albedo *= look_up(material, BASE_COLOR, uv).rgb;
    s.metallic = 0.0;
    if (METALS) s.metallic = base.w;
    s.roughness = further.x;
    if (METALLIC_ROUGHNESS_MAPS) {
        vec2 mr = look_up(material, METALLIC_ROUGHNESS, uv).bg;
        s.metallic *= mr.x;
        s.roughness *= mr.y;
    }
    s.double_sided = (tc.w & SINGLE_SIDED) == 0u;
    s.emission = vec3(0.0);
    s.emitter_density = 0.0;
    if (EMISSION && (s.front || s.double_sided)) {
        s.emission = emission_at(material, uv);
        s.emitter_density = material_numbers(material, 1u).w;
    }
    return s;
}
