#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// A step of running sums by doubling (Bischoff, Schwandt and Broll 2017, equation 12, after Hensley et al. 2005): where each texel has the sum
// of the 2^k texels up to it, it gets that of 2^(k + 1).
layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params {
    ivec2 size;  // of a map's sums
    ivec2 back;  // 2^k texels along one axis
    int column;  // of the sums before, at which those begin
} params;

uniform sampler2DArray sums;
layout(r32f) writeonly uniform image2DArray doubled;

void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(at.xy, params.size))) return;
    ivec3 from = at + ivec3(params.column, 0, 0), before = from - ivec3(params.back, 0);
    float sum = texelFetch(sums, from, 0).r;
    if (all(greaterThanEqual(at.xy - params.back, ivec2(0)))) sum += texelFetch(sums, before, 0).r;
    imageStore(doubled, at, vec4(sum));
}
