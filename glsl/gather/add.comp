#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Sum of the images of two bounces' VPLs.
#include "lib/color.glsl"

layout(local_size_x = 64, local_size_y = 1) in;

layout(scalar, push_constant) uniform Params { ivec2 size; } params;
layout(rgba16f) readonly uniform image2D first;
layout(rgba16f) readonly uniform image2D second;
layout(rgba16f) writeonly uniform image2D irradiance;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, params.size))) return;
    imageStore(irradiance, pixel, min(imageLoad(first, pixel) + imageLoad(second, pixel), vec4(LARGEST_HALF)));
}
