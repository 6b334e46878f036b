#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
// Gather without culling: all VPLs of the sample set.
#include "gather/per-pixel.glsl"

void main() {
    ivec2 pixel = first_pixel();
    Quad pixels = quad_at(pixel);

    uint first = number_of(sample_set());
    uint count = first < params.count ? (params.count - first + SETS - 1u) / SETS : 0u;
    // Each lane of a subgroup fetches and unpacks one VPL and broadcasts it. All lanes sum all VPLs in the same order, whatever the
    // subgroup's size.
    Lanes lanes = lanes_of_subgroup();
    for (uint start = 0u; start < count; start += lanes.count) {
        Vpl mine = vpl(first + min(start + lanes.mine, count - 1u) * SETS, start + lanes.mine < count);
        uvec4 see = seen(pixel, start) & bits_of(lanes);
        // Unrolled by four: llvmpipe ends all loops of an invocation together after 65,535 turns.
        for (uint i = 0u; i < lanes.count; i += 4u) {
            shade_by(pixels, mine, lanes, i, see);
            shade_by(pixels, mine, lanes, i + 1u, see);
            shade_by(pixels, mine, lanes, i + 2u, see);
            shade_by(pixels, mine, lanes, i + 3u, see);
        }
    }
    store(pixels);
    store_numbers(pixels, uvec4(count));
}
