#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Running sums of the importance map along each row, and each row's sum (Barak et al. 2013, section 4.2). A workgroup has a row.
#include "vpls/running-sum.glsl"

layout(scalar, push_constant) uniform Params { uvec2 size; } params; // texels of a map

uniform sampler2DArray importance;
layout(r32f) writeonly uniform image2DArray along_rows;
layout(scalar) writeonly buffer Rows { float at[]; } rows; // of all maps

void main() {
    ivec2 row = ivec2(gl_WorkGroupID.xy); // row, and map
    uint each = (params.size.x + 255u) / 256u, first = gl_LocalInvocationIndex * each, end = min(first + each, params.size.x);
    float block = 0.0;
    for (uint x = first; x < end; x++) block += texelFetch(importance, ivec3(x, row), 0).r;
    float all, before = sum_before(block, all), sum = 0.0;
    for (uint x = first; x < end; x++) {
        sum += texelFetch(importance, ivec3(x, row), 0).r;
        imageStore(along_rows, ivec3(x, row), vec4(before + sum));
    }
    if (gl_LocalInvocationIndex == 0u) rows.at[uint(row.y) * params.size.y + uint(row.x)] = all;
}
