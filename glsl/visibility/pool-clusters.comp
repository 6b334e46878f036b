#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Point clusters, an invocation each, with running sums of the points' areas, by which points are drawn.
#include "visibility/point-cluster.glsl"
#include "visibility/point.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    float diagonal;
    uint each;     // points of a cluster
    uint clusters;
    uint capacity;
    uint groups;
} params;

layout(scalar) readonly buffer Points { Point at[]; } points;
layout(scalar) readonly buffer Begins { uint at[]; } begins;
layout(scalar) writeonly buffer Areas { float at[]; } areas;
layout(scalar) writeonly buffer Clusters { PointCluster at[]; } clusters;
layout(scalar) buffer Made { uint count; } made;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.clusters) return;
    uint low = index * params.each;
    uint high = min(low + params.each, min(begins.at[params.groups], params.capacity));
    PointCluster cluster = PointCluster(vec3(0.0), vec3(0.0), 0.0, 0.0, vec3(0.0));
    vec3 least = vec3(1e30), most = vec3(-1e30);
    float single = 0.0, both = 0.0;
    uint held = 0u;
    for (uint i = low; i < high; i++) {
        Point point = points.at[i];
        if (!point_is_empty(point)) {
            held++;
            float radius = point_radius(point, params.diagonal);
            float area = PI * radius * radius;
            bool double_sided = point_is_double_sided(point);
            cluster.vector_area += double_sided ? vec3(0.0) : point_normal(point) * area;
            single += double_sided ? 0.0 : area;
            both += double_sided ? area : 0.0;
            cluster.area += area;
            least = min(least, point.position);
            most = max(most, point.position);
        }
        areas.at[i] = cluster.area;
    }
    cluster.center = 0.5 * (least + most);
    if (cluster.area > 0.0) cluster.extent = 0.5 * (most - least);
    // The mean projected area of a convex body is a quarter of its surface; that of a double-sided sheet is half.
    cluster.stray = 0.25 * max(single - length(cluster.vector_area), 0.0) + 0.5 * both;
    clusters.at[index] = cluster;
    atomicAdd(made.count, held);
}
