#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Light of the proxy at a pixel: its way and flux are linear over a triangle, so that it moves along with the surface.
#include "lib/color.glsl"
#include "lib/packing.glsl"
#include "lib/pi.glsl"
#include "lib/scene.glsl"

layout(constant_id = 1) const bool BASE_COLOR_MAP = false;
layout(constant_id = 4) const bool MASKED = false;

layout(location = 0) in vec2 in_uv;
layout(location = 1) in float in_alpha;
layout(location = 2) in vec4 in_place[2];
layout(location = 4) in vec4 in_flux[2];

layout(location = 0) out vec4 irradiance;

layout(scalar) uniform MaterialBlock { Material it; } material_block;
uniform sampler2DArray base_color_map;
uniform sampler2D normal;

void main() {
    float alpha = material_block.it.base_color.a * in_alpha;
    if (BASE_COLOR_MAP) alpha *= texture(base_color_map, map_coordinates(material_block.it.base_color_map, in_uv)).a;
    vec3 n = octahedral_inverse(texelFetch(normal, ivec2(gl_FragCoord.xy), 0).xy);
    vec4 flux = gl_FrontFacing ? in_flux[0] : in_flux[1];
    // Without lit caches there is no flux either.
    vec4 place = (gl_FrontFacing ? in_place[0] : in_place[1]) / max(flux.a, 1e-20);
    float squared = dot(place.xyz, place.xyz);
    float cosine = max(dot(n, place.xyz), 0.0) * inversesqrt(max(squared, 1e-30));
    vec3 light = flux.rgb * (cosine / (4.0 * PI * max(squared + place.w * place.w, 1e-30)));
    irradiance = vec4(min(light, vec3(LARGEST_HALF)), 1.0);
    // Discarded last, since derivatives are undefined after it.
    if (MASKED && alpha < material_block.it.alpha_cutoff) discard;
}
