#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
// Light of every VPL at one pixel, by the functions that the gather sums it with, and whether a ray reaches it. Each part for "explain" defines
//     void explain(uint index, Receiver r, float visible, inout VplShare share);
// It completes the share of VPL `index` at a receiver, of whose light the share `visible` arrives by bits, and gives Params, places and the
// shadows.
struct VplShare {
    vec3 position;
    float seen;     // share that the config's visibility leaves; below 0 where it says nothing of the pixel
    vec3 facing;
    float by_rays;  // 1 if a ray reaches the VPL, 0 if not
    vec3 intensity; // radiant intensity towards the pixel, W/sr
    uint is_of_set; // 1 if the pixel's sample set has the VPL
    vec3 open;      // irradiance without shadows and roulette, W/m^2
    vec3 light;     // irradiance as the gather sums it, times the number of sample sets
    vec3 reflected; // radiance that a glossy receiver reflects of it to the eye, times the number of sample sets
};

#include "part/explain=gather/explain-vpl"
#include "lib/interleave.glsl"
#include "part/seen=gather/seen-all"
#include "visibility/shadow-ray.glsl"

layout(local_size_x = 64) in;

layout(scalar) uniform Asked { ivec2 pixel; } asked;
layout(scalar) writeonly buffer Shares { VplShare at[]; } shares;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    Receiver r = receiver(asked.pixel);
    VplPlace place = places.at[index];
    vec3 facing = octahedral_snorm16_inverse(place.normal), way = place.position - r.position;
    bool is_of_set = index % SETS == number_of(uvec2(asked.pixel) % block_size());
    VplShare share = VplShare(place.position, -1.0, facing, 0.0, vec3(0.0), is_of_set ? 1u : 0u, vec3(0.0), vec3(0.0), vec3(0.0));
    if (r.distance > 0.0) {
        // Bits are of the pixel's own set alone.
        explain(index, r, float(seen(asked.pixel, index / SETS).x & 1u), share);
        share.light *= is_of_set ? float(SETS) : 0.0;
        share.reflected *= is_of_set ? float(SETS) : 0.0;
        bool arrives = dot(r.normal, way) > 0.0 && dot(facing, way) < 0.0 && any(greaterThan(share.open, vec3(0.0)));
        if (arrives && reaches(ray_start(r), place.position, facing)) share.by_rays = 1.0;
    }
    shares.at[index] = share;
}
