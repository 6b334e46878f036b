#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "lib/packing.glsl"
#include "lib/scene.glsl"

layout(constant_id = 0) const bool NORMAL_MAP = false;
layout(constant_id = 1) const bool BASE_COLOR_MAP = false;
layout(constant_id = 2) const bool METALLIC_ROUGHNESS_MAP = false;
layout(constant_id = 3) const bool EMISSION_MAP = false;
layout(constant_id = 4) const bool MASKED = false;
layout(constant_id = 5) const bool VERTEX_COLOR = false;

layout(location = 0) in vec3 in_normal;
layout(location = 1) in vec2 in_uv;
layout(location = 2) in vec4 in_color;
layout(location = 3) in vec4 in_tangent;

layout(location = 0) out vec2 normal;
layout(location = 1) out vec4 albedo;
layout(location = 2) out vec2 metallic_roughness;
layout(location = 3) out vec4 emission;

layout(scalar) uniform MaterialBlock { Material it; } material_block;
uniform sampler2DArray base_color_map;
uniform sampler2DArray metallic_roughness_map;
uniform sampler2DArray emission_map;
uniform sampler2DArray normal_map;

void main() {
    Material material = material_block.it;
    vec4 base = material.base_color;
    if (VERTEX_COLOR) base *= in_color;
    if (BASE_COLOR_MAP) base *= texture(base_color_map, map_coordinates(material.base_color_map, in_uv));

    float side = gl_FrontFacing ? 1.0 : -1.0;
    vec3 n = normalize(in_normal);
    if (NORMAL_MAP) {
        vec3 t = in_tangent.xyz - n * dot(n, in_tangent.xyz);
        float squared = dot(t, t);
        if (squared > 0.0) {
            t *= inversesqrt(squared);
            vec3 b = cross(n, t) * in_tangent.w;
            vec3 m = texture(normal_map, map_coordinates(material.normal_map, in_uv)).xyz * 2.0 - 1.0;
            n = normalize(m.x * material.normal_scale * t + m.y * material.normal_scale * b + m.z * n);
        }
    }
    vec2 mr = vec2(material.metallic, material.roughness);
    if (METALLIC_ROUGHNESS_MAP) {
        mr *= texture(metallic_roughness_map, map_coordinates(material.metallic_roughness_map, in_uv)).bg;
    }
    vec3 emitted = material.emission;
    if (EMISSION_MAP) emitted *= texture(emission_map, map_coordinates(material.emission_map, in_uv)).rgb;

    normal = octahedral(n * side);
    albedo = vec4(base.rgb, 1.0);
    metallic_roughness = mr;
    emission = vec4(emitted, 1.0);
    // Discarded last, since derivatives are undefined after it.
    if (MASKED && base.a < material.alpha_cutoff) discard;
}
