#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Number of points of each chunk, written by the last of the workgroups that share it.
#include "visibility/triangles.glsl"

layout(scalar) writeonly buffer Counts { uint at[]; } counts;

void take(uint k, uint total, Point point, uvec4 hash) {}

void main() {
    uint group = params.chunk + group_number();
    if (group >= params.end) return;
    Chunk chunk = chunks.at[group];
    uint total = chunk.slice + 1u == chunk.slices ? count_points(chunk) : 0u;
    if (gl_LocalInvocationID.x == 0u) counts.at[group] = total;
}
