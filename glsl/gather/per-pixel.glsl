// Irradiance from virtual point lights. A pixel of a block sums one sample set of the VPLs. A workgroup takes pixels a block apart, so that
// all of them sum the same VPLs while they access the G-buffer in place (Linke 2016, 4.5).
#include "part/tile=gather/tile-wide"
#include "part/shadow=gather/shadow-none"
#include "gbuffer/receiver.glsl"
#include "lib/color.glsl"
#include "lib/disk.glsl"
#include "lib/interleave.glsl"
#include "lib/packing.glsl"
#include "lib/subgroup.glsl"
#include "lib/vpl.glsl"

layout(constant_id = 3) const bool DISKS = false; // VPLs are disk emitters

layout(scalar, push_constant) uniform Params {
    uint count;
    float squared_min_distance;
} params;

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) readonly buffer Areas { float at[]; } areas;
layout(rgba16f) writeonly uniform image2D irradiance;
#include "part/seen=gather/seen-all"

struct Pixel {
    Receiver at;
    vec3 sum; // irradiance of the VPLs so far, W/m^2
};

Pixel pixel_at(ivec2 place) { return Pixel(receiver(place), vec3(0.0)); }

void store(Pixel p) {
    if (in_picture(p.at.pixel)) imageStore(irradiance, p.at.pixel, vec4(min(p.sum * float(SETS), LARGEST_HALF), 1.0));
}

#include "gather/quad.glsl"

// A VPL, unpacked.
struct Vpl {
    vec3 position;
    vec3 facing;
    vec3 intensity;
    float spread; // square of a disk's radius
    Shadow shadow;
};

// VPL `index`; dark unless `there`.
Vpl vpl(uint index, bool there) {
    VplPlace place = places.at[index];
    vec3 facing = octahedral_snorm16_inverse(place.normal);
    // Disks overlap their neighbours, as reconstruction kernels do: they reach to the diagonal neighbours of a grid.
    float spread = 0.0;
    if (DISKS) spread = max(2.0 * areas.at[index], params.squared_min_distance);
    return Vpl(place.position, facing, there ? intensities.at[index] : vec3(0.0), spread, shadow_of(index, place.position, facing));
}

Vpl hand_round(Vpl mine, uint lane) {
    return Vpl(subgroupBroadcast(mine.position, lane), subgroupBroadcast(mine.facing, lane), subgroupBroadcast(mine.intensity, lane),
               subgroupBroadcast(mine.spread, lane), hand_round(mine.shadow, lane));
}

// Light of a VPL of radiant intensity `intensity` * cosine. d_min bounds the singularity of close points, and is the least radius of a
// disk.
void shade(inout Pixel p, Vpl vpl, float visible) {
    vec3 way = vpl.position - p.at.position;
    float squared = dot(way, way);
    float from = max(-dot(vpl.facing, way), 0.0), to = max(dot(p.at.normal, way), 0.0);
    float weight = DISKS ? disk_light(way, vpl.facing, vpl.spread, p.at.normal)
                         : from * to / max(squared * max(squared, params.squared_min_distance), 1e-20);
    p.sum += vpl.intensity * (weight * visible * lit(vpl.shadow, p.at.normal, way, squared, from, to));
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
