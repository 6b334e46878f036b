#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Areas of the triangles as they are now: a histogram, and the sum and the largest of each chunk. Integers alone are added by atomics, so
// that their order does not matter.
#include "visibility/area-bin.glsl"
#include "visibility/chunk.glsl"

layout(scalar, push_constant) uniform Params {
    uint chunks;
} params;

struct ChunkArea {
    float sum;     // m^2
    float largest; // m^2
};

layout(scalar) buffer Bins { AreaBin at[]; } bins;
layout(scalar) writeonly buffer ChunkAreas { ChunkArea at[]; } chunk_areas;

shared float areas[64];

void main() {
    uint lane = gl_LocalInvocationID.x, group = group_number();
    if (group >= params.chunks) return;
    float area = place_triangle(chunks.at[group]);
    if (area > 0.0) {
        uint bin = area_bin(area);
        atomicAdd(bins.at[bin].count, 1u);
        atomicMax(bins.at[bin].largest, floatBitsToUint(area));
    }
    areas[lane] = area;
    barrier();
    if (lane > 0u) return;
    ChunkArea all = ChunkArea(0.0, 0.0);
    for (uint i = 0u; i < 64u; i++) {
        all.sum += areas[i];
        all.largest = max(all.largest, areas[i]);
    }
    chunk_areas.at[group] = all;
}
