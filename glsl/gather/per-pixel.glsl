// Irradiance from virtual point lights. A pixel of a block sums one sample set of the VPLs. A workgroup takes pixels a block apart, so that
// all of them sum the same VPLs while they access the G-buffer in place (Linke 2016, 4.5).
#include "part/tile=gather/tile-wide"
#include "gather/vpl-light.glsl"
#include "lib/color.glsl"
#include "lib/subgroup.glsl"

layout(rgba16f) writeonly uniform image2D irradiance;
#include "part/numbers=gather/numbers-none"
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

// Number of VPLs of the sample set whose light arrives at a receiver, if nothing shadows it.
uint shining(Receiver r) {
    uint shining = 0u;
    for (uint i = number_of(uvec2(r.pixel) % block_size()); i < params.count; i += SETS) {
        vec3 way = places.at[i].position - r.position;
        bool arrives = dot(octahedral_snorm16_inverse(places.at[i].normal), way) < 0.0 && dot(r.normal, way) > 0.0;
        if (arrives && any(greaterThan(intensities.at[i], vec3(0.0)))) shining++;
    }
    return shining;
}

void store_numbers(Pixel p, uint listed) {
    if (in_picture(p.at.pixel)) store_numbers(p.at.pixel, vec4(float(listed), float(shining(p.at)), 0.0, 0.0));
}

// Stores the numbers of VPLs on the pixels' lists, if they are asked for.
void store_numbers(Quad q, uvec4 listed) {
    if (STATISTICS) {
        store_numbers(q.a, listed.x);
        store_numbers(q.b, listed.y);
        store_numbers(q.c, listed.z);
        store_numbers(q.d, listed.w);
    }
}
