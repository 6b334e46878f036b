// Irradiance from virtual point lights. A pixel of a block sums one sample set of the VPLs. A workgroup takes pixels a block apart, so that
// all of them sum the same VPLs while they access the G-buffer in place (Linke 2016, 4.5).
#include "part/tile=gather/tile-wide"
#include "gather/vpl-light.glsl"
#include "lib/color.glsl"
#include "lib/subgroup.glsl"

layout(rgba16f) writeonly uniform image2D irradiance;
#include "part/seen=gather/seen-all"

void store(Pixel p) {
    if (in_picture(p.at.pixel)) imageStore(irradiance, p.at.pixel, vec4(min(p.sum * float(SETS), LARGEST_HALF), 1.0));
}

#include "gather/quad.glsl"

Vpl hand_round(Vpl mine, uint lane) {
    return Vpl(subgroupBroadcast(mine.position, lane), subgroupBroadcast(mine.facing, lane), subgroupBroadcast(mine.intensity, lane),
               subgroupBroadcast(mine.spread, lane), hand_round(mine.shadow, lane));
}

void shade(inout Quad q, Vpl vpl, vec4 visible) {
    shade(q.a, vpl, visible.x);
    shade(q.b, vpl, visible.y);
    shade(q.c, vpl, visible.z);
    shade(q.d, vpl, visible.w);
}

// Sums the VPL that the lane at place `i` has fetched, at the pixels whose words have bit `i`.
void shade_by(inout Quad q, Vpl mine, Lanes lanes, uint i, uvec4 see) {
    shade(q, hand_round(mine, lane_at(lanes, i)), vec4((see >> i) & 1u));
}

// Neighbouring workgroups process the sample sets of the same block of pixels.
uvec2 sample_set() { return gl_WorkGroupID.xy % block_size(); }

// Corner of the block of pixels that a workgroup shares with its neighbours of other sample sets.
ivec2 block_corner(uvec2 group) { return ivec2(group / block_size() * tile_size() * 2u * block_size()); }

ivec2 first_pixel() { return block_corner(gl_WorkGroupID.xy) + ivec2(place_in_tile() * 2u * block_size() + sample_set()); }
