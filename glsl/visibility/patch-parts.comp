#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Instances of patches whose areas change: as many as the largest triangle of a draw has parts now.
#include "visibility/point.glsl"
#include "visibility/sizes.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    uint pieces;
} params;

struct Arguments {
    uint index_count;
    uint instance_count;
    uint first_index;
    int vertex_offset;
    uint first_instance;
};

struct ChunkArea {
    float sum;
    float largest;
};

layout(scalar) readonly buffer Pieces { uvec2 at[]; } pieces; // first chunk of a draw, and how many
layout(scalar) readonly buffer ChunkAreas { ChunkArea at[]; } chunk_areas;
layout(scalar) buffer ArgumentsOfPatches { Arguments at[]; } arguments;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= params.pieces) return;
    float largest = 0.0;
    for (uint k = 0u; k < pieces.at[i].y; k++) largest = max(largest, chunk_areas.at[pieces.at[i].x + k].largest);
    // Rounding may make it one part more elsewhere.
    uint split = subdivision(largest * 1.001, sizes.max_area).split;
    arguments.at[i].instance_count = largest > 0.0 ? split * split : 0u;
}
