#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Sums the light of each pixel and tone-maps it. Albedo is multiplied in here, after filtering, so that textures stay sharp.
#include "lib/color.glsl"
#include "lib/pi.glsl"
#include "lib/view.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool REINHARD = true;
layout(constant_id = 1) const bool REFLECTION = false; // whether there is glossily reflected indirect light

layout(scalar, push_constant) uniform Params {
    float exposure;
    vec3 background; // added where there is no surface for display; it is no light
} params;

layout(scalar) uniform ViewBlock { View it; } view;
uniform sampler2D depth;
layout(rgba16f) readonly uniform image2D albedo;
uniform sampler2D metallic_roughness;
layout(rgba16f) readonly uniform image2D emission;
layout(rgba16f) readonly uniform image2D direct;
layout(rgba16f) readonly uniform image2D irradiance;
layout(rgba16f) readonly uniform image2D reflection;
layout(rgba16f) writeonly uniform image2D indirect;
layout(rgba16f) writeonly uniform image2D radiance;
layout(rgba8) writeonly uniform image2D image;

#include "part/occlusion=compose/occlusion-none"
#include "part/shown=compose/shown-picture"
#include "part/radiance=sky/radiance-constant"

// Direction in which a pixel's centre looks.
vec3 ahead(ivec2 pixel) {
    vec2 ndc = (vec2(pixel) + 0.5) / vec2(view.it.width, view.it.height) * 2.0 - 1.0;
    return view.it.forward + ndc.x * view.it.right - ndc.y * view.it.up;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), uvec2(view.it.width, view.it.height)))) return;
    bool surface = texelFetch(depth, pixel, 0).r > 0.0;
    float diffuse = 1.0 - texelFetch(metallic_roughness, pixel, 0).r;
    vec3 reflected = indirect_share(pixel) * imageLoad(irradiance, pixel).rgb * imageLoad(albedo, pixel).rgb * (diffuse / PI);
    if (REFLECTION) reflected += indirect_share(pixel) * imageLoad(reflection, pixel).rgb;
    vec3 sum = surface ? reflected + imageLoad(direct, pixel).rgb + imageLoad(emission, pixel).rgb : sky_radiance(ahead(pixel));
    vec3 shown = min(sum, LARGEST_HALF) * params.exposure + (surface ? vec3(0.0) : params.background);
    if (REINHARD) shown = reinhard(shown);
    imageStore(indirect, pixel, vec4(surface ? min(reflected, LARGEST_HALF) : vec3(0.0), 1.0));
    imageStore(radiance, pixel, vec4(min(sum, LARGEST_HALF), surface ? 1.0 : 0.0));
    imageStore(image, pixel, vec4(displayed(pixel, linear_to_srgb(clamp(shown, 0.0, 1.0)), reflected), 1.0));
}
