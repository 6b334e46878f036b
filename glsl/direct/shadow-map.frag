#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Holes of masked surfaces in a shadow map. Nothing else is needed of a surface but its depth.
#include "lib/scene.glsl"

layout(constant_id = 1) const bool BASE_COLOR_MAP = false;
layout(constant_id = 4) const bool MASKED = false;

layout(location = 0) in vec2 in_uv;
layout(location = 1) in vec4 in_color;

layout(scalar) uniform MaterialBlock { Material it; } material_block;
uniform sampler2DArray base_color_map;

void main() {
    if (MASKED) {
        float alpha = material_block.it.base_color.a * in_color.a;
        if (BASE_COLOR_MAP) alpha *= texture(base_color_map, map_coordinates(material_block.it.base_color_map, in_uv)).a;
        if (alpha < material_block.it.alpha_cutoff) discard;
    }
}
