#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Proxy lights: one for each cache, from all VALs (Bischoff, Schwandt and Broll 2017, equations 3, 5, 6, 13 and 14, for diffuse
// light). A workgroup has a cache.
#include "lib/light-cache.glsl"
#include "lib/packing.glsl"
#include "lib/pi.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 256) in;

// Whether brighter VALs draw the proxy nearer; in the paper they do not.
layout(constant_id = 0) const bool BY_FLUX = false;

layout(scalar, push_constant) uniform Params {
    uint caches;
    uint count; // of VALs
} params;

layout(scalar) readonly buffer Caches { LightCache at[]; } caches;
layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) readonly buffer Areas { float at[]; } areas;
layout(scalar) writeonly buffer Proxies { ProxyLight at[]; } proxies;

#include "part/disk=gather/disk-beam"
#include "part/sight=gather/sight-all"

// What is summed over the VALs. Places are relative to the cache, or the variances would drown in their squares.
struct Sums {
    vec3 irradiance;
    float weight;
    vec3 way;
    vec3 squares;
};

shared Sums sums[256];

void main() {
    uint number = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, mine = gl_LocalInvocationID.x;
    bool is_cache = number < params.caches;
    LightCache cache = caches.at[is_cache ? number : 0u];
    Sums sum = Sums(vec3(0.0), 0.0, vec3(0.0), vec3(0.0));
    for (uint i = mine; i < params.count && is_cache; i += 256u) {
        float beam = areas.at[i];
        VplPlace place = places.at[i];
        vec3 way = place.position - cache.position;
        float squared = dot(way, way);
        float to = dot(cache.normal, way), from = -dot(octahedral_snorm16_inverse(place.normal), way);
        if (!(beam > 0.0 && to > 0.0 && from > 0.0) || !is_seen(number, i, params.count)) continue;
        vec2 disk = disk_of(i, beam);
        // The form factor over the disk's area.
        float form = to * from / (squared * (disk.x + PI * squared));
        vec3 intensity = intensities.at[i];
        sum.irradiance += (PI * form) * intensity;
        // A VAL that was drawn with probability P stands for 1 / P of them (equation 13).
        float weight = form * (BY_FLUX ? dot(intensity, vec3(0.2126, 0.7152, 0.0722)) : disk.y);
        sum.weight += weight;
        sum.way += weight * way;
        sum.squares += weight * way * way;
    }
    sums[mine] = sum;
    barrier();
    for (uint half_ = 128u; half_ > 0u; half_ >>= 1u) {
        if (mine < half_) {
            Sums other = sums[mine + half_];
            sums[mine].irradiance += other.irradiance;
            sums[mine].weight += other.weight;
            sums[mine].way += other.way;
            sums[mine].squares += other.squares;
        }
        barrier();
    }
    if (mine != 0u || !is_cache) return;
    Sums all = sums[0];
    // Without light there is no place.
    float scale = all.weight > 0.0 ? 1.0 / all.weight : 0.0;
    vec3 way = all.way * scale;
    vec3 variance = max(all.squares * scale - way * way, vec3(0.0));
    float extent = sqrt(max(variance.x, max(variance.y, variance.z)));
    proxies.at[number] = ProxyLight(way, extent, all.irradiance);
}
