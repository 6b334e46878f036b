#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
// Gather with clustered culling (Linke 2016, section 4.6.1): each pixel sums its froxel's light list. A subgroup processes the froxels of
// its pixels one after the other, so that it can still share VPLs among its lanes.
#include "gather/froxel.glsl"
#include "gather/light-list.glsl"
#include "gather/per-pixel.glsl"

layout(scalar) readonly buffer Rows { uint at[]; } rows;
layout(scalar) readonly buffer Lists { uint at[]; } lists;

const uint NO_ROW = 0xffffffffu;

// Number of the light list of the pixel's froxel.
uint row_of(Receiver r) {
    if (r.distance == 0.0) return NO_ROW;
    ivec2 tile = r.pixel / FROXEL_TILE;
    int across = (int(view.it.width) + FROXEL_TILE - 1) / FROXEL_TILE;
    return rows.at[uint(tile.y * across + tile.x) * SLICES + slice_of(view.it, r.distance)];
}

// Sums the VPL that the lane at place `i` has fetched, at the pixels that are inside its froxel.
void shade_listed(inout Quad q, ivec2 pixel, Vpl mine, uint index, Lanes lanes, uint i, vec4 inside) {
    uint lane = lane_at(lanes, i);
    vec4 visible = inside * float(i < lanes.count) * vec4(seen(pixel, subgroupBroadcast(index, lane) / SETS) & 1u);
    shade(q, hand_round(mine, lane), visible);
}

void main() {
    ivec2 pixel = first_pixel();
    Quad pixels = quad_at(pixel);
    uvec4 mine_rows = uvec4(row_of(pixels.a.at), row_of(pixels.b.at), row_of(pixels.c.at), row_of(pixels.d.at));

    uint set = number_of(sample_set());
    uint stride = part_words(params.count);
    Lanes lanes = lanes_of_subgroup();
    uvec4 left = mine_rows, on_lists = uvec4(0u);
    while (true) {
        uint least = min(min(left.x, left.y), min(left.z, left.w));
        uvec4 some = subgroupBallot(least != NO_ROW);
        if (some == uvec4(0u)) break;
        uint row = subgroupBroadcast(least, subgroupBallotFindLSB(some));
        vec4 inside = vec4(equal(mine_rows, uvec4(row)));
        left = mix(left, uvec4(NO_ROW), equal(left, uvec4(row)));
        for (uint part = set; part < PARTS; part += SETS) {
            uint begin = (row * PARTS + part) * stride;
            uint count = lists.at[begin];
            if (STATISTICS) on_lists += count * uvec4(inside);
            for (uint start = 0u; start < count; start += lanes.count) {
                bool there = start + lanes.mine < count;
                uint place = min(start + lanes.mine, count - 1u);
                uint word = lists.at[begin + 1u + place / PACKED];
                uint index = part + PARTS * bitfieldExtract(word, int(LIST_BITS * (place % PACKED)), int(LIST_BITS));
                Vpl mine = vpl(index, there);
                uint listed = min(lanes.count, count - start);
                // Unrolled by two: llvmpipe ends all loops of an invocation together after 65,535 turns.
                for (uint i = 0u; i < listed; i += 2u) {
                    shade_listed(pixels, pixel, mine, index, lanes, i, inside);
                    shade_listed(pixels, pixel, mine, index, lanes, i + 1u, inside);
                }
            }
        }
    }
    store(pixels);
    store_numbers(pixels, on_lists);
}
