#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Clears the maps to EMPTY.
#include "visibility/ism.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params {
    ivec2 size;
} params;

layout(r32ui) writeonly uniform uimage2D target;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) * ivec2(4, 1);
    for (int i = 0; i < 4; i++) {
        if (texel.x + i < params.size.x && texel.y < params.size.y) imageStore(target, texel + ivec2(i, 0), uvec4(EMPTY));
    }
}
