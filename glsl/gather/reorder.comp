#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Moves pixels that are sorted by sample set to their places in the picture.
#include "lib/color.glsl"
#include "lib/interleave.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params { ivec2 size; } params;

layout(rgba32f) readonly uniform image2D sorted;
layout(rgba16f) writeonly uniform image2D irradiance;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), n = ivec2(block_size());
    if (any(greaterThanEqual(pixel, params.size))) return;
    ivec2 one = (params.size + n - 1) / n;
    vec3 sum = imageLoad(sorted, pixel % n * one + pixel / n).rgb;
    imageStore(irradiance, pixel, vec4(min(sum * float(SETS), LARGEST_HALF), 1.0));
}
