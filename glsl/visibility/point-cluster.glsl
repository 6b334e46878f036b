// A point cluster: neighbouring points of surfaces as one.
struct PointCluster {
    vec3 center;
    vec3 vector_area; // sum of normals times areas, of the single-sided, m^2
    float stray;      // area that the others, and those whose normals cancel out, show to any side on the average, m^2
    float area;       // m^2
    vec3 extent;      // from the centre to the sides of its box
};

// The solid angle under which a VPL sees a point cluster, about.
float cluster_view(PointCluster cluster, vec3 position, vec3 normal) {
    vec3 way = cluster.center - position;
    float squared = dot(way, way);
    float d = sqrt(squared), radius = length(cluster.extent);
    float shown = cluster.stray + max(-dot(cluster.vector_area, way) / max(d, 1e-12), 0.0);
    // Where it is near, it lies all around.
    shown = mix(shown, max(shown, 0.25 * cluster.area), clamp(2.0 * radius / max(d, 1e-12) - 1.0, 0.0, 1.0));
    // What lies behind the VPL cannot be seen: by its box, part of a cluster may.
    float reach = dot(abs(normal), cluster.extent) + 1e-3 * d;
    float before = clamp(0.5 + 0.5 * dot(normal, way) / max(reach, 1e-12), 0.0, 1.0);
    return before * min(shown / max(squared + 0.25 * radius * radius, 1e-12), 6.2831853);
}
