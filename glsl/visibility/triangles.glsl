// Enumerates the points of a chunk of triangles: a workgroup counts the points of each triangle, and shares all points among its
// invocations. An includer defines
//     void take(uint k, uint total, Point point, uvec2 hash);
// for point k of the chunk's `total`, unless it is thinned out.
#include "lib/scene.glsl"
#include "visibility/point.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    float max_area; // of a small triangle, m^2
    float diagonal; // of the scene's bounds, metres
    uint partitions;
    uint capacity;  // points of a partition
    uint seed;
} params;

layout(constant_id = 0) const bool THIN = false;

struct Chunk {
    uint first_index;
    uint triangles;
    uint vertex_offset;
    uint draw;
    uint slice; // number among the `slices` that share the chunk's points
    uint slices;
};

layout(scalar) readonly buffer Chunks { Chunk at[]; } chunks;
layout(scalar) readonly buffer Draws { DrawData at[]; } draws;
layout(scalar) readonly buffer Positions { vec3 at[]; } positions;
layout(scalar) readonly buffer Indices { uint at[]; } indices;

shared uint last[64]; // points up to and with this triangle
shared uvec3 corners[64];
shared vec3 corner[3][64];

// Transforms the chunk's triangles to the world and counts their points.
uint count_points(Chunk chunk) {
    uint lane = gl_LocalInvocationID.x;
    uint count = 0u;
    if (lane < chunk.triangles) {
        mat4x3 transform = draws.at[chunk.draw].transform;
        uvec3 ids;
        for (uint i = 0u; i < 3u; i++) {
            ids[i] = indices.at[chunk.first_index + 3u * lane + i] + chunk.vertex_offset;
            corner[i][lane] = transform * vec4(positions.at[ids[i]], 1.0);
        }
        corners[lane] = ids;
        float area = 0.5 * length(cross(corner[1][lane] - corner[0][lane], corner[2][lane] - corner[0][lane]));
        Subdivision parts = subdivision(area, params.max_area);
        count = area > 0.0 ? parts.split * parts.split * points_of_level(parts.level) : 0u;
    }
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

void take(uint k, uint total, Point point, uvec2 hash);

void go_through(Chunk chunk) {
    bool double_sided = draws.at[chunk.draw].double_sided != 0u;
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
        Subdivision parts = subdivision(area, params.max_area);
        uint each = points_of_level(parts.level);
        uint sub = within / each;
        float share;
        uvec3 place = small_triangle(within - sub * each, parts.level, share);
        if (parts.split > 1u) {
            uvec3 u, v, w;
            sub_triangle(sub, parts.split, u, v, w);
            mat3 whole = mat3(a, b, c);
            float s = float(parts.split);
            a = whole * (vec3(u) / s);
            b = whole * (vec3(v) / s);
            c = whole * (vec3(w) / s);
            area /= s * s;
        }
        uvec2 hash = point_hash(corners[triangle], chunk.draw, sub, place, params.seed);
        area = point_area(area * share, params.max_area, hash.y, THIN);
        if (area > 0.0) {
            vec3 position = (a * float(place.x) + b * float(place.y) + c * float(place.z)) / float(9u * parts.level);
            take(k, total, make_point(position, normal, area, params.diagonal, double_sided), hash);
        }
    }
}
