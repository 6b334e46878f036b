#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Counts the points that the tessellator's splats are made of, those in holes included: squares leave nothing behind to count.
#include "visibility/triangles.glsl"

layout(scalar) buffer Made { uint count; } made;

shared uint taken;

void take(uint k, uint total, Point point, uvec4 hash) { atomicAdd(taken, 1u); }

void main() {
    uint group = params.chunk + group_number();
    if (group >= params.end) return;
    Chunk chunk = chunks.at[group];
    bool first = gl_LocalInvocationID.x == 0u;
    if (first) taken = 0u;
    barrier();
    if (THIN) {
        go_through(chunk);
    } else {
        uint total = count_points(chunk);
        if (first && chunk.slice == 0u) taken = total;
    }
    barrier();
    if (first) atomicAdd(made.count, taken);
}
