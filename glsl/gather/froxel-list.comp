#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// List of the used froxels, and the index of each froxel in it. One workgroup goes through the tiles in order: with an atomic counter, each
// run would give another order.
#include "gather/froxel.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    uint tiles;
} params;

layout(scalar) readonly buffer Slices { uint at[]; } slices;
layout(scalar) writeonly buffer Froxels { uint at[]; } froxels; // tile * SLICES + slice
layout(scalar) writeonly buffer Rows { uint at[]; } rows;
layout(scalar) buffer Used { uint count; } used;

shared uint counts[64];

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint each = (params.tiles + 63u) / 64u;
    uint low = min(lane * each, params.tiles), high = min(low + each, params.tiles);
    uint count = 0u;
    for (uint tile = low; tile < high; tile++) count += bitCount(slices.at[tile]);
    counts[lane] = count;
    barrier();
    uint row = 0u;
    for (uint i = 0u; i < lane; i++) row += counts[i];
    if (lane == 63u) atomicAdd(used.count, row + count);
    for (uint tile = low; tile < high; tile++) {
        for (uint bits = slices.at[tile]; bits != 0u; bits &= bits - 1u) {
            uint froxel = tile * SLICES + uint(findLSB(bits));
            froxels.at[row] = froxel;
            rows.at[froxel] = row;
            row++;
        }
    }
}
