#version 460
#extension GL_EXT_scalar_block_layout : require
// Mean of the moments along a column.
layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params {
    ivec3 size; // width, height, layers
    int radius; // texels
} params;

uniform sampler2DArray moments;
layout(rg32f) writeonly uniform image2DArray blurred;

void main() {
    ivec3 texel = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(texel, params.size))) return;
    vec2 sum = vec2(0.0);
    for (int offset = -params.radius; offset <= params.radius; offset++) {
        int y = clamp(texel.y + offset, 0, params.size.y - 1);
        sum += texelFetch(moments, ivec3(texel.x, y, texel.z), 0).rg;
    }
    imageStore(blurred, texel, vec4(sum / float(2 * params.radius + 1), 0.0, 0.0));
}
