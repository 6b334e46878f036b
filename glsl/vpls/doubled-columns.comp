#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Running sums of the rows' importance in each map, which were made by doubling, where the searches look for them, and running sums of the
// maps' importance.
layout(local_size_x = 256) in;

layout(scalar, push_constant) uniform Params {
    uint rows; // of a map
    uint maps;
} params;

uniform sampler2DArray sums; // a column a map
layout(scalar) writeonly buffer Columns { float at[]; } columns;
layout(scalar) writeonly buffer Maps { float at[]; } maps;

void main() {
    float of_maps = 0.0;
    for (uint map = 0u; map < params.maps; map++) {
        for (uint y = gl_LocalInvocationIndex; y < params.rows; y += 256u) {
            columns.at[map * params.rows + y] = texelFetch(sums, ivec3(0, y, map), 0).r;
        }
        of_maps += texelFetch(sums, ivec3(0, params.rows - 1u, map), 0).r;
        if (gl_LocalInvocationIndex == 0u) maps.at[map] = of_maps;
    }
}
