// Enumerates the points of a chunk of triangles: a workgroup counts the points of each triangle, and shares all points among its
// invocations. An includer defines
//     void take(uint k, uint total, Point point, uvec4 hash);
// for point k of the chunk's `total`, unless it is thinned out or in a hole.
#include "visibility/chunk.glsl"
#include "visibility/patch-params.glsl"
#include "visibility/point.glsl"
#include "visibility/small-corners.glsl"
#include "part/mask=visibility/mask-none"

layout(constant_id = 0) const bool THIN = false;

shared uint last[64]; // points up to and with this triangle

// Transforms the chunk's triangles to the world and counts their points.
uint count_points(Chunk chunk) {
    uint lane = gl_LocalInvocationID.x;
    float area = place_triangle(chunk);
    Subdivision parts = subdivision(area, sizes.max_area);
    uint count = area > 0.0 ? parts.split * parts.split * points_of_level(parts.level) : 0u;
    last[lane] = count;
    barrier();
    // Inclusive prefix sum.
    for (uint step = 1u; step < 64u; step *= 2u) {
        uint before = lane >= step ? last[lane - step] : 0u;
        barrier();
        last[lane] += before;
        barrier();
    }
    return last[63];
}

void take(uint k, uint total, Point point, uvec4 hash);

void go_through(Chunk chunk) {
    bool double_sided = draws.at[chunk.draw].double_sided != 0u;
    uint material = draws.at[chunk.draw].material;
    bool masked = is_masked(material);
    uint total = count_points(chunk);
    for (uint k = chunk.slice * 64u + gl_LocalInvocationID.x; k < total; k += chunk.slices * 64u) {
        uint triangle = 0u;
        for (uint step = 32u; step > 0u; step /= 2u) triangle += last[triangle + step - 1u] <= k ? step : 0u;
        uint within = k - (triangle > 0u ? last[triangle - 1u] : 0u);
        vec3 a = corner[0][triangle], b = corner[1][triangle], c = corner[2][triangle];
        vec3 normal = cross(b - a, c - a);
        float area = length(normal);
        normal /= area;
        area *= 0.5;
        Subdivision parts = subdivision(area, sizes.max_area);
        uint each = points_of_level(parts.level);
        uint sub = within / each;
        float share;
        uvec3 place = small_triangle(within - sub * each, parts.level, share);
        uvec3 u = uvec3(1u, 0u, 0u), v = uvec3(0u, 1u, 0u), w = uvec3(0u, 0u, 1u);
        if (parts.split > 1u) {
            sub_triangle(sub, parts.split, u, v, w);
            mat3 whole = mat3(a, b, c);
            float s = float(parts.split);
            a = whole * (vec3(u) / s);
            b = whole * (vec3(v) / s);
            c = whole * (vec3(w) / s);
            area /= s * s;
        }
        uvec4 hash = point_hash(corners[triangle], chunk.draw, sub, place, params.seed);
        area = point_area(area * share, sizes.max_area, hash.y, THIN);
        if (area > 0.0) {
            vec3 position = (a * float(place.x) + b * float(place.y) + c * float(place.z)) / float(9u * parts.level);
            if (masked) {
                uvec3 thirds[3];
                small_corners(within - sub * each, parts.level, thirds);
                mat3 whole = mat3(vec3(thirds[0]), vec3(thirds[1]), vec3(thirds[2])) / float(3u * parts.level);
                vec3 at = whole * random_weights(thirds[0], thirds[1], thirds[2], hash.zw);
                position = mat3(a, b, c) * at;
                if (is_hole(material, corners[triangle], mat3(vec3(u), vec3(v), vec3(w)) * at / float(parts.split))) continue;
            }
            take(k, total, make_point(position, normal, area, params.diagonal, double_sided), hash);
        }
    }
}
