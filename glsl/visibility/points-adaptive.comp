#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Points for each VPL by solid angle, a workgroup a VPL: it draws point clusters in proportion to their approximate solid angle, and points
// within a cluster by area. Near surfaces get more points, and all maps together as many as before. A point represents more surface where
// few points are drawn.
#include "lib/packing.glsl"
#include "lib/vpl.glsl"
#include "visibility/point-cluster.glsl"
#include "visibility/point.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool GAPS = false; // slots of the pool may be empty

layout(scalar, push_constant) uniform Params {
    float diagonal;
    uint each;     // points of a cluster
    uint clusters; // at most MOST_CLUSTERS
    uint groups;
    uint seed;
} params;

const uint MOST_CLUSTERS = 6144u; // 24 KiB of sums

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Pool { Point at[]; } pool;
layout(scalar) readonly buffer Areas { float at[]; } areas;
layout(scalar) readonly buffer Clusters { PointCluster at[]; } clusters;
layout(scalar) readonly buffer ChunkBegins { uint at[]; } chunk_begins;
layout(scalar) readonly buffer Begins { uint at[]; } begins;
layout(scalar) writeonly buffer Points { Point at[]; } points;
layout(scalar) writeonly buffer Fill { uint at[]; } fill;

shared float sums[6144];
shared float totals[64];

void main() {
    uint vpl = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    uint offset = begins.at[vpl], count = begins.at[vpl + 1u] - offset;
    if (lane == 0u) fill.at[vpl] = count;
    if (count == 0u) return;
    vec3 position = places.at[vpl].position;
    vec3 normal = octahedral_snorm16_inverse(places.at[vpl].normal);
    uint each = (params.clusters + 63u) / 64u;
    uint low = min(lane * each, params.clusters), high = min(low + each, params.clusters);
    float sum = 0.0;
    for (uint i = low; i < high; i++) {
        sum += cluster_view(clusters.at[i], position, normal);
        sums[i] = sum;
    }
    totals[lane] = sum;
    barrier();
    float before = 0.0, total = 0.0;
    for (uint i = 0u; i < 64u; i++) {
        before += i < lane ? totals[i] : 0.0;
        total += totals[i];
    }
    for (uint i = low; i < high; i++) sums[i] += before;
    barrier();
    uint end = chunk_begins.at[params.groups];
    for (uint i = lane; i < count; i += 64u) {
        vec4 u = random(vpl, i, 0u, params.seed);
        float at = (float(i) + u.x) / float(count) * total;
        // Binary search of the first cluster whose running sum is above.
        uint cluster = 0u;
        for (uint step = 4096u; step > 0u; step /= 2u) {
            cluster += cluster + step <= params.clusters - 1u && sums[cluster + step - 1u] <= at ? step : 0u;
        }
        float begin = cluster > 0u ? sums[cluster - 1u] : 0.0;
        float chance = max(sums[cluster] - begin, 1e-20);
        float area = clusters.at[cluster].area;
        float within = clamp((at - begin) / chance, 0.0, 1.0) * area;
        uint first = cluster * params.each, most = min(params.each, end - min(first, end));
        uint k = 0u;
        for (uint step = 4096u; step > 0u; step /= 2u) {
            k += k + step < most && areas.at[first + k + step - 1u] <= within ? step : 0u;
        }
        // Rounding may lead past the cluster's last point.
        while (GAPS && k > 0u && point_is_empty(pool.at[first + k])) k--;
        Point point = pool.at[min(first + k, max(end, 1u) - 1u)];
        float own = point_radius(point, params.diagonal);
        float stands_for = area * total / (float(count) * chance);
        float radius = max(own, sqrt(stands_for / PI));
        points.at[offset + i] =
            make_point(point.position, point_normal(point), PI * radius * radius, params.diagonal, point_is_double_sided(point));
    }
}
