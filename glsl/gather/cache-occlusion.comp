#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Occlusion of the proxy lights by double projection (Bischoff, Schwandt and Broll 2017, section 3, "Occlusion", after Lensing and Broll
// 2013): the proxy's sphere and the caches' disks are projected to the unit sphere around a cache and on to its unit disk (Nusselt's
// analogue), where a body of form factor F covers the area pi F. There they are squares of this area, whose overlap is the occlusion. A
// workgroup has a cache.
#include "lib/basis.glsl"
#include "lib/light-cache.glsl"
#include "lib/pi.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    uint count;
    float least_radius; // of a proxy's sphere, metres
} params;

layout(scalar) readonly buffer Caches { LightCache at[]; } caches;
layout(scalar) readonly buffer Proxies { ProxyLight at[]; } proxies;
layout(scalar) writeonly buffer Seen { float at[]; } seen;

shared float covered[64];

// Overlap of two squares along an axis: their middles and halves of their sides.
float overlap(float a, float half_a, float b, float half_b) {
    return max(min(a + half_a, b + half_b) - max(a - half_a, b - half_b), 0.0);
}

void main() {
    uint number = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, mine = gl_LocalInvocationID.x;
    bool is_cache = number < params.count;
    LightCache cache = caches.at[is_cache ? number : 0u];
    ProxyLight proxy = proxies.at[is_cache ? number : 0u];
    float squared = dot(proxy.way, proxy.way);
    vec3 to_proxy = squared > 0.0 ? proxy.way * inversesqrt(squared) : cache.normal;
    float radius = max(proxy.extent, params.least_radius);
    float form = max(min(radius * radius / max(squared, 1e-30), 1.0) * dot(cache.normal, to_proxy), 1e-8);
    bool is_lit = is_cache && any(greaterThan(proxy.irradiance, vec3(0.0)));
    mat3 frame = basis_of(cache.normal);
    vec2 middle = vec2(dot(to_proxy, frame[0]), dot(to_proxy, frame[1]));
    float half_side = 0.5 * sqrt(PI * form);
    float sum = 0.0;
    for (uint i = mine; i < params.count && is_lit; i += 64u) {
        LightCache other = caches.at[i];
        vec3 way = other.position - cache.position;
        float away = dot(way, way), to = dot(cache.normal, way), facing = -dot(other.normal, way);
        // What is behind the proxy casts no shadow.
        if (!(to > 0.0 && away < squared) || i == number) continue;
        // Each side of a surface that has two has caches of its own. Others stop light from both sides.
        if (other.one_of_two != 0u && facing <= 0.0) continue;
        float disk_form = other.area * to * abs(facing) / (away * (other.area + PI * away));
        float half_disk = 0.5 * sqrt(PI * disk_form), scale = inversesqrt(away);
        vec2 at = vec2(dot(way, frame[0]), dot(way, frame[1])) * scale;
        sum += overlap(middle.x, half_side, at.x, half_disk) * overlap(middle.y, half_side, at.y, half_disk);
    }
    covered[mine] = sum;
    barrier();
    for (uint step_ = 32u; step_ > 0u; step_ >>= 1u) {
        if (mine < step_) covered[mine] += covered[mine + step_];
        barrier();
    }
    if (mine == 0u && is_cache) seen.at[number] = 1.0 - min(covered[0] / (PI * form), 1.0);
}
