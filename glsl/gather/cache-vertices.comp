#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Proxy lights of vertices, from those of the nearest caches (Bischoff, Schwandt and Broll 2017, equations 7 to 9): an invocation a vertex of
// an instance.
#include "gather/vertex-light.glsl"
#include "lib/light-cache.glsl"
#include "lib/packing.glsl"
#include "lib/pi.glsl"
#include "lib/scene.glsl"
#include "lib/vertex.glsl"
#include "lib/view.glsl"
#include "part/proxies=gather/proxies-one"

layout(local_size_x = 64) in;

const uint NEIGHBOURS = 16u;

// Whether a proxy's extent bounds its light nearby; in the paper nothing does.
layout(constant_id = 0) const bool BOUNDED = true;
// Lights of a vertex for each proxy: a second one for the other side.
layout(constant_id = 1) const uint SIDES = 1u;
// Whether caches lose weight with their distance from the tangent plane, too.
layout(constant_id = 2) const bool ON_PLANE = false;

layout(scalar, push_constant) uniform Params {
    uint count;
    float off_plane; // distance from a cache's tangent plane at which it has no weight, metres
} params;

// A vertex of an instance.
struct ListedVertex {
    uint vertex;
    uint list;
    uint draw;        // NO_CACHE if no triangle has the vertex
    uint first_cache; // of the instance
    uint sides;       // lit ones: draws of one side and of two may share a vertex
};

layout(scalar) uniform ViewBlock { View it; } view;
layout(scalar) readonly buffer Listed { ListedVertex at[]; } listed;
layout(scalar) readonly buffer Lists { uint at[]; } lists;
layout(scalar) readonly buffer Draws { DrawData at[]; } draws;
layout(scalar) readonly buffer Vertices { Vertex at[]; } vertices;
layout(scalar) readonly buffer Caches { LightCache at[]; } caches;
layout(scalar) readonly buffer Proxies { ProxyLight at[]; } proxies;
layout(scalar) writeonly buffer Lights { VertexLight at[]; } vertex_lights;
layout(scalar) buffer Alone { uint count; } alone; // vertices at whose front no cache has weight

#include "part/reach=gather/reach-all"

// A side of a vertex.
struct Place {
    vec3 position;
    vec3 normal;
};

// Lights of one side, by proxies, and their caches' weights.
struct Sums {
    VertexLight light[PROXIES];
    float weights[PROXIES];
};

// Adds proxy `kind` of a cache. A dark one has no place, and counts among the fluxes alone.
void add(inout VertexLight sum, Place place, LightCache cache, uint number, float weight) {
    ProxyLight proxy = proxies.at[number];
    float squared = dot(proxy.way, proxy.way), extent = BOUNDED ? proxy.extent : 0.0;
    float cosine = dot(cache.normal, proxy.way) * inversesqrt(max(squared, 1e-30));
    if (!(cosine > 0.0) || all(equal(proxy.irradiance, vec3(0.0)))) return;
    sum.way += weight * (proxy.way + (cache.position - place.position));
    sum.extent += weight * extent;
    sum.flux += (weight * reach_of(number) * 4.0 * PI * (squared + extent * extent) / proxy_cosine(cosine, squared, extent)) * proxy.irradiance;
    sum.lit += weight;
}

void write_lights(uint first, Place place, ListedVertex it, bool is_front) {
    uint list = it.list * NEIGHBOURS;
    float farthest = 0.0;
    // The nearest cache that faces the same side, for where none has weight.
    uint nearest = NO_CACHE;
    for (uint j = 0u; j < NEIGHBOURS; j++) {
        uint neighbour = lists.at[list + j];
        if (neighbour == NO_CACHE) continue;
        LightCache cache = caches.at[it.first_cache + neighbour];
        farthest = max(farthest, distance(place.position, cache.position));
        if (nearest == NO_CACHE && dot(place.normal, cache.normal) > 0.0) nearest = it.first_cache + neighbour;
    }
    vec3 eye = view.it.position, mirrored = mirror_direction(place.position - eye, place.normal);
    Sums sums;
    for (uint kind = 0u; kind < PROXIES; kind++) {
        sums.light[kind] = VertexLight(vec3(0.0), 0.0, vec3(0.0), 0.0);
        sums.weights[kind] = 0.0;
    }
    for (uint j = 0u; j < NEIGHBOURS; j++) {
        uint neighbour = lists.at[list + j];
        if (neighbour == NO_CACHE) continue;
        uint number = it.first_cache + neighbour;
        LightCache cache = caches.at[number];
        float alike = dot(place.normal, cache.normal);
        // Of a cache on the other side, the mirror direction is the same.
        if (!(alike > 0.0)) continue;
        vec3 from = place.position - cache.position;
        float near = 1.0 - length(from) / max(farthest, 1e-30);
        if (ON_PLANE) near *= max(1.0 - abs(dot(cache.normal, from)) / params.off_plane, 0.0);
        for (uint kind = 0u; kind < PROXIES; kind++) {
            if (kind == 1u) alike = max(dot(mirrored, mirror_direction(cache.position - eye, cache.normal)), 0.0);
            float weight = near * sqrt(alike);
            // The farthest cache has no weight, whatever its distance is rounded to.
            if (!(weight > 1e-6)) continue;
            sums.weights[kind] += weight;
            add(sums.light[kind], place, cache, number * PROXIES + kind, weight);
        }
    }
    for (uint kind = 0u; kind < PROXIES; kind++) {
        VertexLight sum = sums.light[kind];
        if (sums.weights[kind] > 0.0) {
            float share = sums.weights[kind];
            sum = VertexLight(sum.way / share, sum.extent / share, sum.flux / share, sum.lit / share);
        } else {
            if (kind == 0u && is_front) atomicAdd(alone.count, 1u);
            if (nearest != NO_CACHE) add(sum, place, caches.at[nearest], nearest * PROXIES + kind, 1.0);
        }
        vertex_lights.at[first + kind] = sum;
    }
}

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (i >= params.count) return;
    ListedVertex it = listed.at[i];
    if (it.draw == NO_CACHE) return;
    mat4x3 transform = draws.at[it.draw].transform;
    mat3 linear = mat3(transform);
    mat3 cofactor = mat3(cross(linear[1], linear[2]), cross(linear[2], linear[0]), cross(linear[0], linear[1]));
    float orientation = dot(linear[0], cofactor[0]) < 0.0 ? -1.0 : 1.0;
    Vertex vertex = vertices.at[it.vertex];
    vec3 position = transform * vec4(vertex.position, 1.0);
    vec3 normal = normalize(cofactor * octahedral_snorm16_inverse(vertex.normal) * orientation);
    for (uint side = 0u; side < SIDES; side++) {
        uint first = (i * SIDES + side) * PROXIES;
        if (side < it.sides) {
            write_lights(first, Place(position, side == 0u ? normal : -normal), it, side == 0u);
        } else {
            for (uint kind = 0u; kind < PROXIES; kind++) vertex_lights.at[first + kind] = VertexLight(vec3(0.0), 0.0, vec3(0.0), 0.0);
        }
    }
}
