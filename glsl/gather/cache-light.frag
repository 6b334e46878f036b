#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Light of the proxies at a pixel: their ways and fluxes are linear over a triangle, so that they move along with the surface. A part for
// "mirror" defines
//     float mirror(Receiver r, vec3 to_light);
// which reflects the glossy proxy, and returns the share that remains for diffuse reflection of light from a direction.
#include "gbuffer/receiver.glsl"
#include "lib/color.glsl"
#include "lib/light-cache.glsl"
#include "lib/pi.glsl"
#include "lib/scene.glsl"
#include "part/proxies=gather/proxies-one"

layout(constant_id = 1) const bool BASE_COLOR_MAP = false;
layout(constant_id = 4) const bool MASKED = false;

layout(location = 0) in vec2 in_uv;
layout(location = 1) in float in_alpha;
layout(location = 2) in vec4 in_place[2u * PROXIES];
layout(location = 6) in vec4 in_flux[2u * PROXIES];

layout(location = 0) out vec4 irradiance;

layout(scalar) uniform MaterialBlock { Material it; } material_block;
uniform sampler2DArray base_color_map;

// Light of a proxy on a surface: irradiance, W/m^2, and the direction that it comes from.
struct Arriving {
    vec3 light;
    vec3 to_light;
};

Arriving arriving(uint kind, vec3 n) {
    vec4 flux = gl_FrontFacing ? in_flux[kind] : in_flux[PROXIES + kind];
    // Without lit caches there is no flux either.
    vec4 place = (gl_FrontFacing ? in_place[kind] : in_place[PROXIES + kind]) / max(flux.a, 1e-20);
    float squared = dot(place.xyz, place.xyz);
    vec3 to_light = place.xyz * inversesqrt(max(squared, 1e-30));
    float cosine = proxy_cosine(dot(n, to_light), squared, place.w);
    return Arriving(flux.rgb * (cosine / (4.0 * PI * max(squared + place.w * place.w, 1e-30))), to_light);
}

#include "part/mirror=gather/mirror-none"

void main() {
    float alpha = material_block.it.base_color.a * in_alpha;
    if (BASE_COLOR_MAP) alpha *= texture(base_color_map, map_coordinates(material_block.it.base_color_map, in_uv)).a;
    Receiver r = receiver(ivec2(gl_FragCoord.xy));
    Arriving diffuse = arriving(0u, r.normal);
    irradiance = vec4(min(diffuse.light * mirror(r, diffuse.to_light), vec3(LARGEST_HALF)), 1.0);
    // Discarded last, since derivatives are undefined after it.
    if (MASKED && alpha < material_block.it.alpha_cutoff) discard;
}
