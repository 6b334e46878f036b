#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// All points in the order of their triangles, so that neighbours are adjacent. Points that are thinned out leave an empty slot.
#include "visibility/triangles.glsl"

layout(scalar) readonly buffer Begins { uint at[]; } begins;
layout(scalar) writeonly buffer Points { Point at[]; } points;

void take(uint k, uint total, Point point, uvec4 hash) {
    uint slot = begins.at[params.chunk + group_number()] + k;
    if (slot < params.capacity) points.at[slot] = point;
}

void main() {
    uint group = params.chunk + group_number();
    if (group < params.end) go_through(chunks.at[group]);
}
