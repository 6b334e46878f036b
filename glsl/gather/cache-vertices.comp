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
    uint draw; // NO_CACHE if no triangle has the vertex
    uint first_cache; // of the instance
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

// Adds proxy `kind` of a cache. A dark one has no place, and counts among the fluxes alone.
void add(inout VertexLight sum, Place place, uint cache_number, uint kind, float weight) {
    LightCache cache = caches.at[cache_number];
    ProxyLight proxy = proxies.at[cache_number * PROXIES + kind];
    float squared = dot(proxy.way, proxy.way), extent = BOUNDED ? proxy.extent : 0.0;
    float cosine = dot(cache.normal, proxy.way) * inversesqrt(max(squared, 1e-30));
    if (!(cosine > 0.0) || all(equal(proxy.irradiance, vec3(0.0)))) return;
    sum.way += weight * (proxy.way + (cache.position - place.position));
    sum.extent += weight * extent;
    sum.flux += (weight * reach_of(cache_number * PROXIES + kind) * 4.0 * PI * (squared + extent * extent) / cosine) * proxy.irradiance;
    sum.lit += weight;
}

VertexLight light_at(Place place, ListedVertex it, uint kind, bool is_front) {
    uint first = it.list * NEIGHBOURS;
    float farthest = 0.0;
    // The nearest cache that faces the same side, for where none has weight.
    uint nearest = NO_CACHE;
    for (uint j = 0u; j < NEIGHBOURS; j++) {
        uint neighbour = lists.at[first + j];
        if (neighbour == NO_CACHE) continue;
        LightCache cache = caches.at[it.first_cache + neighbour];
        farthest = max(farthest, distance(place.position, cache.position));
        if (nearest == NO_CACHE && dot(place.normal, cache.normal) > 0.0) nearest = it.first_cache + neighbour;
    }
    vec3 eye = view.it.position, mirrored = mirror_direction(place.position - eye, place.normal);
    VertexLight sum = VertexLight(vec3(0.0), 0.0, vec3(0.0), 0.0);
    float weights = 0.0;
    for (uint j = 0u; j < NEIGHBOURS; j++) {
        uint neighbour = lists.at[first + j];
        if (neighbour == NO_CACHE) continue;
        uint number = it.first_cache + neighbour;
        LightCache cache = caches.at[number];
        vec3 from = place.position - cache.position;
        float alike = max(dot(place.normal, cache.normal), 0.0);
        // Of a cache on the other side, the mirror direction is the same.
        if (kind == 1u && alike > 0.0) alike = max(dot(mirrored, mirror_direction(cache.position - eye, cache.normal)), 0.0);
        float weight = (1.0 - length(from) / max(farthest, 1e-30)) * sqrt(alike);
        if (ON_PLANE) weight *= max(1.0 - abs(dot(cache.normal, from)) / params.off_plane, 0.0);
        // The farthest cache has no weight, whatever its distance is rounded to.
        if (!(weight > 1e-6)) continue;
        weights += weight;
        add(sum, place, number, kind, weight);
    }
    if (!(weights > 0.0)) {
        if (kind == 0u && is_front) atomicAdd(alone.count, 1u);
        if (nearest != NO_CACHE) add(sum, place, nearest, kind, 1.0);
        return sum;
    }
    return VertexLight(sum.way / weights, sum.extent / weights, sum.flux / weights, sum.lit / weights);
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
    // Draws of one and of two sides may share a vertex.
    for (uint side = 0u; side < SIDES; side++) {
        Place place = Place(position, side == 0u ? normal : -normal);
        for (uint kind = 0u; kind < PROXIES; kind++) {
            vertex_lights.at[(i * SIDES + side) * PROXIES + kind] = light_at(place, it, kind, side == 0u);
        }
    }
}
