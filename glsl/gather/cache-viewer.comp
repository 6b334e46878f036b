#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Pictures of the light caches, as disks of the surface that each stands for and in the light that reaches it, and of their proxy lights, in
// false colour by the irradiance that they give their cache.
#include "gather/cache-tile.glsl"
#include "gbuffer/receiver.glsl"
#include "lib/color.glsl"
#include "lib/false-color.glsl"
#include "lib/light-cache.glsl"
#include "lib/pi.glsl"
#include "part/proxies=gather/proxies-one"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params {
    uint count;     // caches
    float distance; // radius of a disk, at most, metres
} params;

layout(scalar) readonly buffer Caches { LightCache at[]; } caches;
layout(scalar) readonly buffer Tiles { CacheTile at[]; } tiles;
layout(scalar) readonly buffer Proxies { ProxyLight at[]; } proxies;
layout(scalar) readonly buffer Marks { uint at[]; } marks; // number of the proxy light that a pixel is near to, plus 1
layout(rgba8) writeonly uniform image2D disks;
layout(rgba8) writeonly uniform image2D lights;

#include "part/reach=gather/reach-all"

// The nearest cache whose disk has a surface, and the surface's place on the disk, in radii.
uint cache_at(Receiver r, out float along) {
    uint nearest = NO_CACHE;
    float least = params.distance;
    along = 0.0;
    for (uint tile = 0u; tile * 64u < params.count; tile++) {
        CacheTile bounds = tiles.at[tile];
        vec3 off = max(max(bounds.low - r.position, r.position - bounds.high), vec3(0.0));
        if (dot(off, off) > least * least) continue;
        for (uint i = tile * 64u; i < min(tile * 64u + 64u, params.count); i++) {
            LightCache cache = caches.at[i];
            vec3 from = r.position - cache.position;
            float height = dot(from, cache.normal), away = length(from - height * cache.normal), radius = sqrt(cache.area / PI);
            if (away < min(radius, least) && abs(height) < 0.5 * radius && dot(cache.normal, r.normal) > 0.3) {
                nearest = i;
                least = away;
                along = away / radius;
            }
        }
    }
    return nearest;
}

vec3 displayed(vec3 radiance) { return linear_to_srgb(clamp(reinhard(radiance), 0.0, 1.0)); }

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (!in_picture(pixel)) return;
    Receiver r = receiver(pixel);
    // Surfaces between the disks are grey, darker the more they turn away.
    vec3 grey = vec3(0.0);
    if (r.distance > 0.0) grey = vec3(0.02 + 0.08 * abs(dot(r.normal, normalize(view.it.position - r.position))));
    vec3 disk = grey;
    if (r.distance > 0.0) {
        float along;
        uint cache = cache_at(r, along);
        if (cache != NO_CACHE) disk = along > 0.9 ? vec3(0.0) : proxies.at[cache * PROXIES].irradiance * (reach_of(cache * PROXIES) / PI);
    }
    imageStore(disks, pixel, vec4(displayed(disk), 1.0));
    uint mark = marks.at[uint(pixel.y) * view.it.width + uint(pixel.x)];
    vec3 light = displayed(grey);
    if (mark != 0u) {
        float irradiance = luminance(proxies.at[(mark - 1u) * PROXIES].irradiance);
        light = false_color(irradiance / (1.0 + irradiance));
    }
    imageStore(lights, pixel, vec4(light, 1.0));
}
