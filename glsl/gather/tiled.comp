#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
// Gather with tiled culling (Linke 2016, section 4.6.2): it skips VPLs whose hemisphere misses the bounds of the workgroup's pixels. The
// light list is a ballot of the subgroup over the VPLs just fetched, so it keeps their order, and every sum its bits.
#include "gather/froxel.glsl"
#include "gather/per-pixel.glsl"

shared uint nearest; // bits of distances, which sort as these
shared uint farthest;

void main() {
    ivec2 pixel = first_pixel();
    Quad pixels = quad_at(pixel);

    if (gl_LocalInvocationIndex == 0u) {
        nearest = 0x7f800000u;
        farthest = 0u;
    }
    barrier();
    vec4 distances = distances_of(pixels);
    vec4 least = mix(distances, vec4(1e30), equal(distances, vec4(0.0)));
    atomicMin(nearest, floatBitsToUint(min(min(least.x, least.y), min(least.z, least.w))));
    atomicMax(farthest, floatBitsToUint(max(max(distances.x, distances.y), max(distances.z, distances.w))));
    barrier();
    Frustum tile = frustum(view.it, block_corner(gl_WorkGroupID.xy), block_corner(gl_WorkGroupID.xy + block_size()),
                           uintBitsToFloat(nearest), uintBitsToFloat(farthest));

    uint first = number_of(sample_set());
    uint count = first < params.count ? (params.count - first + SETS - 1u) / SETS : 0u;
    Lanes lanes = lanes_of_subgroup();
    uint on_list = 0u;
    for (uint start = 0u; start < count; start += lanes.count) {
        bool there = start + lanes.mine < count && lanes.mine < lanes.count;
        Vpl mine = vpl(first + min(start + lanes.mine, count - 1u) * SETS, there);
        bool listed = there && any(greaterThan(mine.intensity, vec3(0.0))) && is_lit(tile, mine.position, mine.facing);
        uint list = ballot_from(subgroupBallot(listed), lanes.first);
        if (STATISTICS) on_list += uint(bitCount(list));
        uvec4 all_seen = seen(pixel, start);
        // Unrolled by two: llvmpipe ends all loops of an invocation together after 65,535 turns.
        while (list != 0u) {
            uint i = uint(findLSB(list));
            list &= list - 1u;
            uvec4 see = all_seen;
            shade_by(pixels, mine, lanes, i, see);
            see = list != 0u ? all_seen : uvec4(0u);
            i = list != 0u ? uint(findLSB(list)) : i;
            list &= list - 1u;
            shade_by(pixels, mine, lanes, i, see);
        }
    }
    store(pixels);
    store_numbers(pixels, uvec4(on_list));
}
