#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Points from triangles without the tessellator: the same points, each in the partition given by its hash.
#include "visibility/triangles.glsl"

layout(scalar) writeonly buffer Points { Point at[]; } points;
layout(scalar) buffer Fill { uint at[]; } fill;

void take(uint k, uint total, Point point, uvec4 hash) {
    uint part = hashed_index(hash.x, params.partitions) - params.first;
    if (part >= params.held) return;
    uint slot = atomicAdd(fill.at[part], 1u);
    if (slot < params.capacity) points.at[part * params.capacity + slot] = point;
}

void main() {
    uint group = params.chunk + group_number();
    if (group < params.end) go_through(chunks.at[group]);
}
