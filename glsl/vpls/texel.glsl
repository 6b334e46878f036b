// Shared by the samplers of reflective shadow maps: the map of a sample, and the VPL of a texel.
#include "lib/brdf.glsl"
#include "lib/packing.glsl"
#include "lib/permutation.glsl"
#include "lib/vpl.glsl"
#include "vpls/params.glsl"
#include "vpls/rsm.glsl"

layout(scalar) writeonly buffer Places { VplPlace at[]; } places;
layout(scalar) writeonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) writeonly buffer Areas { float at[]; } areas;
layout(scalar) buffer Lit { uint count; } lit;

#include "part/disk=vpls/disk-none"
#include "part/lobe=vpls/lobe-none"

// Map of a sample, and its number among the map's samples; the first maps get the remainder of the division.
void map_of(uint sample_index, out uint layer, out uint k, out uint count) {
    uint share = params.count / params.lights, rest = params.count % params.lights;
    uint larger = (share + 1u) * rest;
    layer = sample_index < larger ? sample_index / (share + 1u) : rest + (sample_index - larger) / share;
    count = share + uint(layer < rest);
    k = sample_index - (layer * share + min(layer, rest));
}

// Map and number for VPL `index`, whose sample is given by a fixed permutation.
void share_of(uint index, out uint layer, out uint k, out uint count) { map_of(permutation(index, params.count), layer, k, count); }

// Stores VPL `index` at a texel; it represents `texels` texels.
void put(uint index, ivec3 at, float texels) {
    VplPlace place = VplPlace(vec3(0.0), 0u);
    vec3 intensity = vec3(0.0);
    float area = 0.0, disk = 0.0;
    float depth = texelFetch(rsm_depth, at, 0).r;
    if (depth > 0.0) {
        vec2 ndc = (vec2(at.xy) + 0.5) / vec2(params.size) * 2.0 - 1.0;
        place.position = light_position(lights.at[at.z], ndc, depth);
        place.normal = octahedral_snorm16(octahedral_inverse(texelFetch(rsm_normal, at, 0).xy));
        disk = texel_disk(lights.at[at.z], ndc, place.position);
        area = texels * texel_beam(lights.at[at.z], ndc, place.position);
        intensity = texelFetch(rsm_flux, at, 0).rgb * texelFetch(rsm_albedo, at, 0).rgb * (texels / PI);
    }
    bool glossy = put_lobe(index, depth > 0.0 ? at : ivec3(-1), texels, place.position);
    if (all(equal(intensity, vec3(0.0))) && !glossy) area = 0.0;
    places.at[index] = place;
    intensities.at[index] = intensity;
    areas.at[index] = area;
    put_disk(index, area > 0.0 ? vec2(disk, texels * disk) : vec2(0.0));
    if (area > 0.0) atomicAdd(lit.count, 1u);
}
