#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Running sums of the rows' importance in each map, the last column of Barak et al. 2013, section 4.2, and of the maps' importance.
#include "vpls/running-sum.glsl"

layout(scalar, push_constant) uniform Params {
    uint rows; // of a map
    uint maps;
} params;

layout(scalar) readonly buffer Rows { float at[]; } rows;
layout(scalar) writeonly buffer Columns { float at[]; } columns;
layout(scalar) writeonly buffer Maps { float at[]; } maps;

void main() {
    uint each = (params.rows + 255u) / 256u, first = gl_LocalInvocationIndex * each, end = min(first + each, params.rows);
    float of_maps = 0.0;
    for (uint map = 0u; map < params.maps; map++) {
        float block = 0.0;
        for (uint y = first; y < end; y++) block += rows.at[map * params.rows + y];
        float all, before = sum_before(block, all), sum = 0.0;
        for (uint y = first; y < end; y++) {
            sum += rows.at[map * params.rows + y];
            columns.at[map * params.rows + y] = before + sum;
        }
        of_maps += all;
        if (gl_LocalInvocationIndex == 0u) maps.at[map] = of_maps;
        barrier();
    }
}
