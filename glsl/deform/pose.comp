#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Copies the pose into an image: a software driver loads a texel at once, and a buffer word by word and lane by lane.
layout(local_size_x = 64) in;

layout(scalar) readonly buffer Words { uvec4 at[]; } words;
layout(rgba32ui) writeonly uniform uimage2D pose;

void main() {
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    imageStore(pose, at, words.at[(at.y << 10) + at.x]);
}
