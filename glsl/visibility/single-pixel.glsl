// Points as single pixels (Linke 2016, section 4.4.3): a column of workgroups a partition. Each point is tested against the partition's VPL and those
// that follow it, and drawn into the maps of the first few that can see it. An includer defines
//     void put(ivec2 texel, uint word, vec3 normal, vec3 w, vec2 p);
// which stores a texel's word (the point's normal and direction are in the VPL's space, p is its place in the disk), and
//     void put_total(uint drawn, uint lost);
// which adds the counts of a workgroup or an invocation.
#include "lib/basis.glsl"
#include "lib/vpl.glsl"
#include "visibility/ism.glsl"
#include "visibility/point.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint MAP_SIZE = 64;
layout(constant_id = 1) const bool DISTORTION = true;
layout(constant_id = 2) const bool ROUND = true; // no normals are kept
layout(constant_id = 3) const bool GAPS = false; // slots may be empty
layout(constant_id = 4) const float GROWN = 0.75; // radius added to a point's, texels

#include "part/projection=visibility/projection-paraboloid"

layout(scalar, push_constant) uniform Params {
    uint count;      // VPLs
    uint first;      // VPL of the first partition
    uint shares;     // VPLs that share the points: all, or 1 if each has its own
    uint considered; // VPLs a point is tested against, at most 32
    uint collected;  // VPLs that a point is drawn for, at most
    uint columns;    // maps side by side
    float far;       // far distance of the maps, metres
    float diagonal;
    float enlarge;   // factor of all radii
} params;

layout(scalar) readonly buffer Points { Point at[]; } points;
layout(scalar) readonly buffer Begins { uint at[]; } begins; // start of each partition, and the end
layout(scalar) readonly buffer Fill { uint at[]; } fill;
layout(scalar) readonly buffer Places { VplPlace at[]; } places;

shared vec3 position[32];
shared mat3 axes[32];
shared ivec2 corner[32];

void put(ivec2 texel, uint word, vec3 normal, vec3 w, vec2 p);
void put_total(uint drawn, uint lost);

void main() {
    uint part = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (lane < params.considered) {
        uint vpl = (part + params.first + lane) % params.count;
        position[lane] = places.at[vpl].position;
        axes[lane] = basis_of(octahedral_snorm16_inverse(places.at[vpl].normal));
        corner[lane] = map_corner(vpl, params.columns, int(MAP_SIZE));
    }
    barrier();
    uint begin = begins.at[part], held = fill.at[part];
    // The order of atomics decides which points an overfull partition has lost: to stay deterministic, it draws none.
    if (held > begins.at[part + 1u] - begin) {
        if (lane == 0u && gl_WorkGroupID.y == 0u) put_total(0u, held);
        held = 0u;
    }
    uint total = 0u;
    for (uint i = gl_WorkGroupID.y * 64u + lane; i < held; i += gl_NumWorkGroups.y * 64u) {
        Point point = points.at[begin + i];
        if (GAPS && point_is_empty(point)) continue;
        vec3 normal = point_normal(point);
        uint seen = 0u;
        for (uint k = 0u; k < params.considered; k++) {
            vec3 way = sight(point.position - position[k], axes[k][2]);
            seen |= uint(is_in_the_way(point, normal, way, axes[k][2])) << k;
        }
        uint passing = bitCount(seen), rest = min(passing, params.collected);
        total += rest;
        float radius = point_radius(point, params.diagonal);
        radius *= params.enlarge * point_enlargement(params.shares, params.considered, passing, max(rest, 1u));
        for (uint k = 0u; k < params.considered; k++) {
            if ((seen >> k & 1u) != 0u && rest > 0u) {
                rest--;
                vec3 from = point.position - position[k], way = sight(from, axes[k][2]);
                uint vpl = (part + k) % params.count;
                float d = length(way);
                vec3 w = way * axes[k] / d;
                vec2 p = place_in_map(vpl, from, w);
                ivec2 texel = clamp(ivec2((p * 0.5 + 0.5) * float(MAP_SIZE)), ivec2(0), ivec2(MAP_SIZE - 1u));
                // A disk at an angle covers less area; if normals are kept, they give the ellipse.
                float seen_radius = radius;
                if (DISTORTION) {
                    if (ROUND) seen_radius *= sqrt(abs(dot(normal, way)) / d);
                }
                float size = radius_in_map(vpl, seen_radius, d, w.z) * (0.5 * float(MAP_SIZE));
                // The radius grows because the texel's centre is not the point's position.
                vec3 local = normal * axes[k];
                if (ROUND) {
                    size = sqrt(size * size + GROWN * GROWN);
                } else {
                    // Depth of the disk's plane at the texel's centre.
                    vec3 middle = paraboloid_inverse((vec2(texel) + 0.5) * (2.0 / float(MAP_SIZE)) - 1.0);
                    float runs = dot(local, w) / dot(local, middle);
                    d *= runs > 0.0 ? clamp(runs, 0.8, 1.25) : 1.0;
                }
                put(corner[k] + texel, pack_pixel(d / params.far, size), local, w, p);
            }
        }
    }
    if (total > 0u) put_total(total, 0u);
}
