#version 460
#extension GL_EXT_scalar_block_layout : require
// Counts the texels of an image with a channel that is not finite.
layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params {
    uvec3 size; // width, height, layers
    uint slot;
} params;

uniform sampler2DArray image;
layout(scalar) buffer Counts { uint counts[]; } counts;

void main() {
    if (any(greaterThanEqual(gl_GlobalInvocationID, params.size))) return;
    vec4 texel = texelFetch(image, ivec3(gl_GlobalInvocationID), 0);
    // Tested by bits: compilers may assume that arithmetic meets finite numbers only.
    if (any(equal(floatBitsToUint(texel) & 0x7f800000u, uvec4(0x7f800000u)))) atomicAdd(counts.counts[params.slot], 1u);
}
