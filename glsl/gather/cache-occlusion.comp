#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Occlusion of the proxy lights by double projection (Bischoff, Schwandt and Broll 2017, section 3, "Occlusion", after Lensing and Broll
// 2013): the proxy's sphere and the caches' disks are projected to the unit sphere around a cache and on to its unit disk (Nusselt's
// analogue), where a body of form factor F covers the area pi F. There they are squares of this area, whose overlap is the occlusion. A
// workgroup has four caches, which lie close together, and skips tiles of others that are behind them or farther off than their lights.
#include "gather/cache-tile.glsl"
#include "lib/basis.glsl"
#include "lib/light-cache.glsl"
#include "lib/pi.glsl"
#include "part/proxies=gather/proxies-one"

layout(local_size_x = 32) in;

const uint LANES = 32u;

// Whether a cache must lie before all of a proxy's sphere to shadow it, and not only before its middle.
layout(constant_id = 0) const bool BEFORE_SPHERE = false;
// Whether surfaces shadow what is before them alone.
layout(constant_id = 1) const bool FRONTS = false;
// Whether a cache's disk is what its surface is spread over, with gaps, and not its surface's area at one place.
layout(constant_id = 2) const bool SILHOUETTES = false;

layout(scalar, push_constant) uniform Params {
    uint count;
    float least_radius; // of a proxy's sphere, metres
    float deviations;   // radius of a sphere, in standard deviations
} params;

layout(scalar) readonly buffer Caches { LightCache at[]; } caches;
layout(scalar) readonly buffer Tiles { CacheTile at[]; } tiles;
layout(scalar) readonly buffer Proxies { ProxyLight at[]; } proxies;
layout(scalar) writeonly buffer Seen { float at[]; } seen;
layout(scalar) buffer Within { uint count; } within; // caches that lie within the sphere of their diffuse light

// A proxy as a square on the unit disk.
struct Square {
    vec2 middle;
    float half_side;
    float form;    // the sphere's form factor
    float reach;   // square of the distance within which caches shadow it
    float covered; // area of the squares over it so far
};

// A cache, and its lights.
struct Target {
    uint number;
    bool is_cache;
    LightCache cache;
    mat3 frame;
    Square diffuse;
    Square glossy;
};

shared uint listed[2]; // tiles, a bit each
shared vec4 covered[LANES][2]; // areas over the lights of the four caches: diffuse and glossy

Square square_of(LightCache cache, ProxyLight proxy, mat3 frame) {
    float squared = dot(proxy.way, proxy.way);
    bool is_lit = any(greaterThan(proxy.irradiance, vec3(0.0)));
    vec3 to_proxy = squared > 0.0 ? proxy.way * inversesqrt(squared) : cache.normal;
    float radius = max(params.deviations * proxy.extent, params.least_radius);
    float form = max(min(radius * radius / max(squared, 1e-30), 1.0) * dot(cache.normal, to_proxy), 1e-8);
    float reach = BEFORE_SPHERE ? max(sqrt(squared) - radius, 0.0) : sqrt(squared);
    return Square(vec2(dot(to_proxy, frame[0]), dot(to_proxy, frame[1])), 0.5 * sqrt(PI * form), form, is_lit ? reach * reach : 0.0, 0.0);
}

// Overlap of two squares along an axis: their middles and halves of their sides.
float overlap(float a, float half_a, float b, float half_b) {
    return max(min(a + half_a, b + half_b) - max(a - half_a, b - half_b), 0.0);
}

void cover(inout Square square, float away, vec2 at, float half_side, float opacity) {
    if (away < square.reach) {
        square.covered += opacity * overlap(square.middle.x, square.half_side, at.x, half_side) * overlap(square.middle.y, square.half_side, at.y, half_side);
    }
}

Target target_of(uint number) {
    bool is_cache = number < params.count;
    uint mine = is_cache ? number : 0u;
    LightCache cache = caches.at[mine];
    mat3 frame = basis_of(cache.normal);
    Square diffuse = square_of(cache, proxies.at[mine * PROXIES], frame), glossy = diffuse;
    if (PROXIES == 2u) glossy = square_of(cache, proxies.at[mine * PROXIES + 1u], frame);
    if (!is_cache) diffuse.reach = glossy.reach = 0.0;
    return Target(number, is_cache, cache, frame, diffuse, glossy);
}

// Adds what cache `i` hides.
void hide(inout Target target, uint i, LightCache other) {
    vec3 way = other.position - target.cache.position;
    float away = dot(way, way), to = dot(target.cache.normal, way), facing = -dot(other.normal, way);
    if (!(to > 0.0 && away < max(target.diffuse.reach, target.glossy.reach)) || i == target.number) return;
    // Each side of a surface that has two has caches of its own.
    if ((FRONTS || other.one_of_two != 0u) && facing <= 0.0) return;
    float area = SILHOUETTES ? other.silhouette : other.area, opacity = SILHOUETTES ? other.opacity : 1.0;
    float form = area * to * abs(facing) / (away * (area + PI * away));
    vec2 at = vec2(dot(way, target.frame[0]), dot(way, target.frame[1])) * inversesqrt(away);
    float half_side = 0.5 * sqrt(PI * form);
    cover(target.diffuse, away, at, half_side, opacity);
    if (PROXIES == 2u) cover(target.glossy, away, at, half_side, opacity);
}

// Whether a tile may have a cache that is before the plane and within a squared distance, with slack far above the rounding.
bool meets(CacheTile tile, Target target) {
    vec3 low = tile.low - target.cache.position, high = tile.high - target.cache.position;
    vec3 off = max(max(low, -high), vec3(0.0)), up = max(target.cache.normal * low, target.cache.normal * high);
    float reach = max(target.diffuse.reach, target.glossy.reach);
    return dot(off, off) <= reach * 1.0001 && dot(up, vec3(1.0)) > -1e-5 * dot(abs(up), vec3(1.0));
}

// Stores the shares that reach a cache, and counts it if it lies within the sphere of its diffuse light.
void store(Target target, vec2 hidden) {
    if (!target.is_cache) return;
    seen.at[target.number * PROXIES] = 1.0 - min(hidden.x / (PI * target.diffuse.form), 1.0);
    if (PROXIES == 2u) seen.at[target.number * PROXIES + 1u] = 1.0 - min(hidden.y / (PI * target.glossy.form), 1.0);
    ProxyLight proxy = proxies.at[target.number * PROXIES];
    bool is_lit = any(greaterThan(proxy.irradiance, vec3(0.0)));
    if (is_lit && length(proxy.way) < max(params.deviations * proxy.extent, params.least_radius)) atomicAdd(within.count, 1u);
}

void main() {
    uint first_target = 4u * (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x), me = gl_LocalInvocationID.x;
    Target a = target_of(first_target), b = target_of(first_target + 1u), c = target_of(first_target + 2u), d = target_of(first_target + 3u);
    uint all_tiles = (params.count + 63u) / 64u;
    for (uint first = 0u; first < all_tiles; first += 2u * LANES) {
        barrier();
        if (me < 2u) listed[me] = 0u;
        barrier();
        for (uint word = 0u; word < 2u; word++) {
            uint number = first + word * LANES + me;
            if (number >= all_tiles) continue;
            CacheTile tile = tiles.at[number];
            if (meets(tile, a) || meets(tile, b) || meets(tile, c) || meets(tile, d)) atomicOr(listed[word], 1u << me);
        }
        barrier();
        for (uint word = 0u; word < 2u; word++) {
            uint bits = listed[word];
            while (bits != 0u) {
                uint tile = first + word * LANES + uint(findLSB(bits));
                bits &= bits - 1u;
                for (uint i = tile * 64u + me; i < min(tile * 64u + 64u, params.count); i += LANES) {
                    LightCache other = caches.at[i];
                    hide(a, i, other);
                    hide(b, i, other);
                    hide(c, i, other);
                    hide(d, i, other);
                }
            }
        }
    }
    covered[me][0] = vec4(a.diffuse.covered, b.diffuse.covered, c.diffuse.covered, d.diffuse.covered);
    covered[me][1] = vec4(a.glossy.covered, b.glossy.covered, c.glossy.covered, d.glossy.covered);
    barrier();
    for (uint half_ = LANES / 2u; half_ > 0u; half_ >>= 1u) {
        if (me < half_) {
            covered[me][0] += covered[me + half_][0];
            covered[me][1] += covered[me + half_][1];
        }
        barrier();
    }
    if (me != 0u) return;
    vec4 diffuse = covered[0][0], glossy = covered[0][1];
    store(a, vec2(diffuse.x, glossy.x));
    store(b, vec2(diffuse.y, glossy.y));
    store(c, vec2(diffuse.z, glossy.z));
    store(d, vec2(diffuse.w, glossy.w));
}
