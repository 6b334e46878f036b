#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "lib/light.glsl"
#include "lib/packing.glsl"
#include "lib/scene.glsl"

layout(constant_id = 0) const bool SEVERAL_LIGHTS = true;
layout(constant_id = 1) const bool BASE_COLOR_MAP = false;
layout(constant_id = 2) const bool METALLIC_ROUGHNESS_MAP = false;
layout(constant_id = 4) const bool MASKED = false;
layout(constant_id = 5) const bool VERTEX_COLOR = false;
layout(constant_id = 6) const uint LIGHT_KIND = 4; // of all lights, or MIXED

layout(location = 0) in vec2 in_uv;
layout(location = 1) in vec4 in_color;
layout(location = 2) flat in uint in_light;

layout(location = 0) out vec2 normal;
layout(location = 1) out vec4 albedo;

layout(scalar, push_constant) uniform Params {
    vec2 texel_size;  // of the map, in [-1, 1]
    float albedo_lod; // added to the mip level, so that the albedo is the mean over the area that a VPL stands for
} params;

layout(scalar) uniform LightsBlock { Light at[MAX_LIGHTS]; } lights;
layout(scalar) uniform MaterialBlock { Material it; } material_block;
uniform sampler2DArray base_color_map;
uniform sampler2DArray metallic_roughness_map;

void main() {
    Material material = material_block.it;
    vec4 base = material.base_color;
    if (VERTEX_COLOR) base *= in_color;
    vec3 tint = base.rgb;
    if (BASE_COLOR_MAP) {
        vec3 coordinates = map_coordinates(material.base_color_map, in_uv);
        tint *= texture(base_color_map, coordinates, params.albedo_lod).rgb;
        if (MASKED) base.a *= texture(base_color_map, coordinates).a;
    }

    float metallic = material.metallic;
    if (METALLIC_ROUGHNESS_MAP) {
        metallic *= texture(metallic_roughness_map, map_coordinates(material.metallic_roughness_map, in_uv), params.albedo_lod).b;
    }

    uint layer = 0u;
    if (SEVERAL_LIGHTS) layer = in_light;
    Light light = lights.at[layer];
    if (LIGHT_KIND != MIXED) light.kind = LIGHT_KIND;
    vec2 ndc = gl_FragCoord.xy * params.texel_size - 1.0;
    vec2 gradient = vec2(dFdx(gl_FragCoord.z), dFdy(gl_FragCoord.z)) / params.texel_size;
    bool lit = gl_FrontFacing || material.double_sided != 0u;
    normal = octahedral(light_normal(light, ndc, gl_FragCoord.z, gradient));
    albedo = vec4(lit ? tint * (1.0 - metallic) : vec3(0.0), 1.0);
    // Last, since derivatives mean nothing after it.
    if (MASKED && base.a < material.alpha_cutoff) discard;
}
