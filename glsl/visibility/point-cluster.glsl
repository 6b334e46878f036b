// A point cluster: neighbouring points, taken as one surface.
struct PointCluster {
    vec3 center;
    vec3 vector_area; // sum of area times normal of single-sided points, m^2
    float stray;      // mean projected area of double-sided points and of cancelling normals, m^2
    float area;       // m^2
    vec3 extent;      // half the size of its box
};

// Approximate solid angle of a point cluster, seen from a VPL.
float cluster_view(PointCluster cluster, vec3 position, vec3 normal) {
    vec3 way = cluster.center - position;
    float squared = dot(way, way);
    float d = sqrt(squared), radius = length(cluster.extent);
    float shown = cluster.stray + max(-dot(cluster.vector_area, way) / max(d, 1e-12), 0.0);
    // A near cluster surrounds the VPL.
    shown = mix(shown, max(shown, 0.25 * cluster.area), clamp(2.0 * radius / max(d, 1e-12) - 1.0, 0.0, 1.0));
    // Points behind the VPL are invisible; the box gives the visible part of a cluster.
    float reach = dot(abs(normal), cluster.extent) + 1e-3 * d;
    float before = clamp(0.5 + 0.5 * dot(normal, way) / max(reach, 1e-12), 0.0, 1.0);
    return before * min(shown / max(squared + 0.25 * radius * radius, 1e-12), 6.2831853);
}
