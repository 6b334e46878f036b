#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Light lists of the used froxels: a workgroup a froxel, an invocation a part of its list, so that parts keep the VPLs' order. Those VPLs are
// listed whose hemisphere reaches into the froxel.
#include "gather/froxel.glsl"
#include "gather/light-list.glsl"
#include "lib/packing.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    uint count; // VPLs
} params;

layout(scalar) uniform ViewBlock { View it; } view;
layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) readonly buffer Froxels { uint at[]; } froxels;
layout(scalar) readonly buffer Used { uint count; } used;
layout(scalar) writeonly buffer Lists { uint at[]; } lists;

void main() {
    uint row = gl_WorkGroupID.x, part = gl_LocalInvocationID.x;
    if (row >= used.count || part >= PARTS) return;
    uint froxel = froxels.at[row];
    uint tile = froxel / SLICES, slice = froxel % SLICES;
    uint across = (view.it.width + uint(FROXEL_TILE) - 1u) / uint(FROXEL_TILE);
    ivec2 low = ivec2(tile % across, tile / across) * FROXEL_TILE;
    float end = slice + 1u < SLICES ? slice_begin(view.it, slice + 1u) : 1e3 * view.it.diagonal;
    Frustum f = frustum(view.it, low, low + FROXEL_TILE, slice_begin(view.it, slice), end);
    uint begin = (row * PARTS + part) * part_words(params.count);
    uint listed = 0u, word = 0u;
    for (uint i = part; i < params.count; i += PARTS) {
        VplPlace place = places.at[i];
        if (any(greaterThan(intensities.at[i], vec3(0.0))) && is_lit(f, place.position, octahedral_snorm16_inverse(place.normal))) {
            word |= i / PARTS << LIST_BITS * (listed % PACKED);
            listed++;
            if (listed % PACKED == 0u) {
                lists.at[begin + listed / PACKED] = word;
                word = 0u;
            }
        }
    }
    if (listed % PACKED != 0u) lists.at[begin + listed / PACKED + 1u] = word;
    lists.at[begin] = listed;
}
