#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Distances along the view's axis, of every pixel or of every second pixel of every second row, in a format that a software driver loads
// fast.
#include "lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params {
    ivec2 size;
    int step; // pixels of the picture a texel
} params;

layout(scalar) uniform ViewBlock { View it; } view;
uniform sampler2D depth;
layout(r32f) writeonly uniform image2D distances; // 0 without a surface

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, params.size))) return;
    float z = texelFetch(depth, texel * params.step, 0).r;
    imageStore(distances, texel, vec4(z > 0.0 ? view.it.near / z : 0.0));
}
