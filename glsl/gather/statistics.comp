#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Picture of light lists: brightness is the number of VPLs on a pixel's lists, up to 256; colour is the share that does not shine there,
// from blue over green to red (Tokuyoshi and Harada 2017, figures 9 and 10). Diffuse and glossy VPLs are counted together.
#include "lib/color.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params { ivec2 size; } params;

uniform sampler2D depth;
layout(rgba32f) readonly uniform image2D numbers;
layout(scalar) buffer Pixels { uint count; } pixels;
layout(scalar) buffer DiffuseListed { uint count; } diffuse_listed;
layout(scalar) buffer DiffuseLit { uint count; } diffuse_lit;
layout(scalar) buffer DiffuseWrong { uint count; } diffuse_wrong;
layout(scalar) buffer GlossyListed { uint count; } glossy_listed;
layout(scalar) buffer GlossyLit { uint count; } glossy_lit;
layout(scalar) buffer GlossyWrong { uint count; } glossy_wrong;
layout(rgba8) writeonly uniform image2D picture;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, params.size))) return;
    uvec4 number = uvec4(imageLoad(numbers, pixel));
    if (texelFetch(depth, pixel, 0).r > 0.0) {
        atomicAdd(pixels.count, 1u);
        atomicAdd(diffuse_listed.count, number.x);
        atomicAdd(diffuse_lit.count, number.y);
        atomicAdd(diffuse_wrong.count, number.x - number.y);
        atomicAdd(glossy_listed.count, number.z);
        atomicAdd(glossy_lit.count, number.w);
        atomicAdd(glossy_wrong.count, number.z - number.w);
    }
    uvec2 shown = number.xy + number.zw;
    float wrong = float(shown.x - shown.y) / float(max(shown.x, 1u));
    bool surface = texelFetch(depth, pixel, 0).r > 0.0;
    vec3 hue = clamp(vec3(2.0 * wrong - 1.0, 1.0 - abs(2.0 * wrong - 1.0), 1.0 - 2.0 * wrong), 0.0, 1.0);
    imageStore(picture, pixel, vec4(linear_to_srgb(hue * (surface ? min(float(shown.x) / 256.0, 1.0) : 0.0)), 1.0));
}
