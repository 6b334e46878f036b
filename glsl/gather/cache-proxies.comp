#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Proxy lights of the caches, from all VALs (Bischoff, Schwandt and Broll 2017, equations 3 to 6 and 13 to 15). A workgroup has four caches: a
// VAL is fetched and unpacked once for them.
#include "lib/light-cache.glsl"
#include "lib/packing.glsl"
#include "lib/pi.glsl"
#include "lib/view.glsl"
#include "lib/vpl.glsl"
#include "part/proxies=gather/proxies-one"

layout(local_size_x = 32) in;

const uint LANES = 32u;

// Whether brighter VALs draw the proxy nearer; in the paper they do not.
layout(constant_id = 0) const bool BY_FLUX = false;
// Whether a glossy proxy's light is bounded where its place is off the lobe; in the paper nothing bounds it.
layout(constant_id = 1) const bool BOUNDED = true;

layout(scalar, push_constant) uniform Params {
    uint caches;
    uint count; // of VALs
} params;

layout(scalar) uniform ViewBlock { View it; } view;
layout(scalar) readonly buffer Caches { LightCache at[]; } caches;
layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) writeonly buffer Proxies { ProxyLight at[]; } proxies;
layout(scalar) buffer Dark { uint count; } dark; // caches without light

#include "part/disk=gather/disk-beam"
#include "part/sight=gather/sight-all"

// What is summed over the VALs. Places are relative to the cache, or the variances would drown in their squares.
struct Sums {
    vec3 irradiance;
    float weight;
    vec3 way;
    float lobe; // of a glossy proxy alone
    vec3 squares;
};

const Sums NOTHING = Sums(vec3(0.0), 0.0, vec3(0.0), 0.0, vec3(0.0));

// A cache and its sums so far.
struct Gathering {
    uint number;
    bool is_cache;
    LightCache cache;
    vec3 mirrored; // direction from which a mirror would reflect to the eye
    Sums diffuse;
    Sums glossy;
};

Gathering gathering(uint number) {
    bool is_cache = number < params.caches;
    LightCache cache = caches.at[is_cache ? number : 0u];
    vec3 mirrored = vec3(0.0);
    if (PROXIES == 2u) mirrored = mirror_direction(cache.position - view.it.position, cache.normal);
    return Gathering(number, is_cache, cache, mirrored, NOTHING, NOTHING);
}

void add(inout Sums sums, vec3 light, float weight, vec3 way) {
    sums.irradiance += light;
    sums.weight += weight;
    sums.way += weight * way;
    sums.squares += weight * way * way;
}

// Adds VAL i. `disk` has its area, and that of all VALs that it stands for: one that was drawn with probability P stands for 1 / P of them
// (equation 13).
void add(inout Gathering g, uint i, vec3 position, vec3 facing, vec3 intensity, vec2 disk) {
    vec3 way = position - g.cache.position;
    float squared = dot(way, way), to = dot(g.cache.normal, way), from = -dot(facing, way);
    if (!(to > 0.0 && from > 0.0 && g.is_cache) || !is_seen(g.number, i, params.count)) return;
    // The form factor over the disk's area.
    float form = to * from / (squared * (disk.x + PI * squared));
    vec3 light = (PI * form) * intensity;
    float weight = form * (BY_FLUX ? dot(intensity, vec3(0.2126, 0.7152, 0.0722)) : disk.y);
    add(g.diffuse, light, weight, way);
    if (PROXIES == 2u) {
        float lobe = cosine_lobe(dot(g.mirrored, way) * inversesqrt(squared), g.cache.exponent);
        add(g.glossy, lobe * light, lobe * weight, way);
        g.glossy.lobe += lobe * weight * lobe;
    }
}

shared Sums sums[LANES];

// Sums of all invocations, for the first one.
Sums total(Sums mine) {
    uint me = gl_LocalInvocationID.x;
    barrier();
    sums[me] = mine;
    barrier();
    for (uint half_ = LANES / 2u; half_ > 0u; half_ >>= 1u) {
        if (me < half_) {
            Sums other = sums[me + half_];
            sums[me].irradiance += other.irradiance;
            sums[me].weight += other.weight;
            sums[me].way += other.way;
            sums[me].lobe += other.lobe;
            sums[me].squares += other.squares;
        }
        barrier();
    }
    return sums[0];
}

// Without light there is no place.
ProxyLight proxy_of(Sums all) {
    // The inverse of a weight that is almost 0 is infinite.
    float scale = all.weight > 1e-30 ? 1.0 / all.weight : 0.0;
    vec3 way = all.way * scale;
    vec3 variance = max(all.squares * scale - way * way, vec3(0.0));
    return ProxyLight(way, sqrt(max(variance.x, max(variance.y, variance.z))), all.irradiance);
}

void finish(Gathering g) {
    Sums diffuse = total(g.diffuse), glossy = NOTHING;
    if (PROXIES == 2u) glossy = total(g.glossy);
    if (gl_LocalInvocationID.x != 0u || !g.is_cache) return;
    proxies.at[g.number * PROXIES] = proxy_of(diffuse);
    if (all(equal(diffuse.irradiance, vec3(0.0)))) atomicAdd(dark.count, 1u);
    if (PROXIES == 2u) {
        ProxyLight proxy = proxy_of(glossy);
        // Reflected by the lobe from the proxy's place, this irradiance is what the lobe reflects of all VALs (equation 7). The place may be
        // off the lobe, where the VALs are not.
        float squared = dot(proxy.way, proxy.way);
        float lobe = cosine_lobe(dot(g.mirrored, proxy.way) * inversesqrt(max(squared, 1e-30)), g.cache.exponent);
        if (BOUNDED) lobe = max(lobe, glossy.weight > 1e-30 ? glossy.lobe / glossy.weight : 1.0);
        proxy.irradiance /= max(lobe, 1e-8);
        proxies.at[g.number * PROXIES + 1u] = proxy;
    }
}

// The workgroup's caches.
struct Four {
    Gathering a;
    Gathering b;
    Gathering c;
    Gathering d;
};

void add(inout Four four, uint i) {
    vec2 disk = i < params.count ? disk_of(i) : vec2(0.0);
    if (!(disk.y > 0.0)) return;
    VplPlace place = places.at[i];
    vec3 facing = octahedral_snorm16_inverse(place.normal), intensity = intensities.at[i];
    add(four.a, i, place.position, facing, intensity, disk);
    add(four.b, i, place.position, facing, intensity, disk);
    add(four.c, i, place.position, facing, intensity, disk);
    add(four.d, i, place.position, facing, intensity, disk);
}

void main() {
    uint first = 4u * (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x);
    Four four = Four(gathering(first), gathering(first + 1u), gathering(first + 2u), gathering(first + 3u));
    // Four VALs a turn: llvmpipe ends all loops of an invocation together after 65,535 turns.
    for (uint i = gl_LocalInvocationID.x; i < params.count; i += 4u * LANES) {
        add(four, i);
        add(four, i + LANES);
        add(four, i + 2u * LANES);
        add(four, i + 3u * LANES);
    }
    finish(four.a);
    finish(four.b);
    finish(four.c);
    finish(four.d);
}
