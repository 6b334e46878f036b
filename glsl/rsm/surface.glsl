// Texel of a reflective shadow map: material properties, averaged over a VPL's footprint.
#include "lib/footprint.glsl"
#include "lib/light.glsl"
#include "lib/packing.glsl"
#include "lib/scene.glsl"

layout(constant_id = 0) const bool SEVERAL_LIGHTS = true;
layout(constant_id = 1) const bool BASE_COLOR_MAP = false;
layout(constant_id = 2) const bool METALLIC_ROUGHNESS_MAP = false;
layout(constant_id = 4) const bool MASKED = false;
layout(constant_id = 5) const bool VERTEX_COLOR = false;
layout(constant_id = 6) const uint LIGHT_KIND = 4; // of all lights, or MIXED
layout(constant_id = 8) const bool WHOLE_MAPS = false; // means of whole textures, not over a VPL's footprint

layout(location = 0) in vec2 in_uv;
layout(location = 1) in vec4 in_color;
layout(location = 2) flat in uint in_light;

layout(location = 0) out vec2 normal;
layout(location = 1) out vec4 albedo;

layout(scalar, push_constant) uniform Params {
    vec2 texel_size;  // of the map, in [-1, 1]
    float albedo_lod; // mips: averages the albedo over a VPL's footprint
} params;

layout(scalar) uniform LightsBlock { Light at[MAX_LIGHTS]; } lights;
layout(scalar) uniform MaterialBlock { Material it; } material_block;
uniform sampler2DArray base_color_map;
uniform sampler2DArray metallic_roughness_map;

// Mean of a texture.
vec4 mean_of(sampler2DArray map, vec3 coordinates) {
    // The coarsest mip.
    if (WHOLE_MAPS) return textureLod(map, coordinates, 32.0);
    return mean_over(map, coordinates, params.albedo_lod);
}

struct Surface {
    vec3 tint;       // base colour
    float alpha;     // coverage
    float metallic;
    float roughness;
    bool lit;        // lit from its front, or double-sided
};

Surface surface() {
    Material material = material_block.it;
    vec4 base = material.base_color;
    if (VERTEX_COLOR) base *= in_color;
    Surface it = Surface(base.rgb, base.a, material.metallic, material.roughness, gl_FrontFacing || material.double_sided != 0u);
    if (BASE_COLOR_MAP) {
        vec3 coordinates = map_coordinates(material.base_color_map, in_uv);
        it.tint *= mean_of(base_color_map, coordinates).rgb;
        if (MASKED) it.alpha *= texture(base_color_map, coordinates).a;
    }
    if (METALLIC_ROUGHNESS_MAP) {
        vec2 mr = mean_of(metallic_roughness_map, map_coordinates(material.metallic_roughness_map, in_uv)).bg;
        it.metallic *= mr.x;
        it.roughness *= mr.y;
    }
    return it;
}

void put_diffuse(Surface it) {
    uint layer = 0u;
    if (SEVERAL_LIGHTS) layer = in_light;
    Light light = lights.at[layer];
    if (LIGHT_KIND != MIXED) light.kind = LIGHT_KIND;
    vec2 ndc = gl_FragCoord.xy * params.texel_size - 1.0;
    vec2 gradient = vec2(dFdx(gl_FragCoord.z), dFdy(gl_FragCoord.z)) / params.texel_size;
    normal = octahedral(light_normal(light, ndc, gl_FragCoord.z, gradient));
    albedo = vec4(it.lit ? it.tint * (1.0 - it.metallic) : vec3(0.0), 1.0);
}

// Discarded last, since derivatives are undefined after it.
void cut_out(Surface it) {
    if (MASKED && it.alpha < material_block.it.alpha_cutoff) discard;
}
