// Light of a virtual point light at a receiver, as gathers without Russian roulette sum it. The visibility is the part "shadow".
#include "part/shadow=gather/shadow-none"
#include "gbuffer/receiver.glsl"
#include "lib/disk.glsl"
#include "lib/interleave.glsl"
#include "lib/packing.glsl"
#include "lib/vpl.glsl"

layout(constant_id = 3) const bool DISKS = false; // VPLs are disk emitters

layout(scalar, push_constant) uniform Params {
    uint count;
    float squared_min_distance;
} params;

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) readonly buffer Areas { float at[]; } areas;

struct Pixel {
    Receiver at;
    vec3 sum; // irradiance of the VPLs so far, W/m^2
};

Pixel pixel_at(ivec2 place) { return Pixel(receiver(place), vec3(0.0)); }

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

// Irradiance of an unshadowed VPL, over its intensity: 1/m^2. d_min bounds the singularity of close points, and is the least radius of a
// disk.
float form_factor(Vpl vpl, vec3 normal, vec3 way, float squared, float from, float to) {
    return DISKS ? disk_light(way, vpl.facing, vpl.spread, normal) : from * to / max(squared * max(squared, params.squared_min_distance), 1e-20);
}

// Light of a VPL of radiant intensity `intensity` * cosine.
void shade(inout Pixel p, Vpl vpl, float visible) {
    vec3 way = vpl.position - p.at.position;
    float squared = dot(way, way);
    float from = max(-dot(vpl.facing, way), 0.0), to = max(dot(p.at.normal, way), 0.0);
    float weight = form_factor(vpl, p.at.normal, way, squared, from, to);
    p.sum += vpl.intensity * (weight * visible * lit(vpl.shadow, p.at.normal, way, squared, from, to));
}
