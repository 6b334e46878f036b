#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Converts the reversed depth of splats to distances.
layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params {
    ivec2 size;
} params;

uniform sampler2D splats;
layout(r32f) writeonly uniform image2D maps;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, params.size))) return;
    imageStore(maps, texel, vec4(1.0 - texelFetch(splats, texel, 0).r));
}
