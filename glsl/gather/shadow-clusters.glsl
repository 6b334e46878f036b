// Shadows by the maps of VPL clusters (Aranha et al., section III-C). A VPL is taken to see all that its cluster's representative sees,
// which is biased.
#include "bounce/vpl-cluster.glsl"
#include "lib/basis.glsl"
#include "lib/packing.glsl"
#include "lib/paraboloid.glsl"

layout(constant_id = 2) const bool BILINEAR = true;

layout(scalar) uniform ClustersBlock {
    float far;  // distance of the value 1, metres
    float bias; // widths of a texel
    int size;   // side of a map, texels
} maps_of;
layout(scalar) readonly buffer Clusters { VplCluster at[]; } clusters;
layout(scalar) readonly buffer Labels { uint at[]; } labels;
layout(r32f) readonly uniform image2DArray maps;

struct Shadow {
    vec3 across; // the map's axes
    vec3 up;
    vec3 moved;  // from the VPL to the cluster's representative
    float near;  // 0.5 / length(moved)
    int layer;
};

Shadow shadow_of(uint vpl, vec3 position, vec3 facing) {
    uint label = labels.at[vpl];
    if (label == NO_CLUSTER) label = 0u;
    VplCluster cluster = clusters.at[label];
    mat3 axes = basis_of(octahedral_snorm16_inverse(cluster.normal));
    vec3 moved = cluster.position - position;
    return Shadow(axes[0], axes[1], moved, 0.5 / max(length(moved), 1e-12), int(label));
}

Shadow hand_round(Shadow shadow, uint lane) {
    return Shadow(subgroupBroadcast(shadow.across, lane), subgroupBroadcast(shadow.up, lane), subgroupBroadcast(shadow.moved, lane),
                  subgroupBroadcast(shadow.near, lane), subgroupBroadcast(shadow.layer, lane));
}

float lit(Shadow shadow, vec3 normal, vec3 way, float squared, float from, float to) {
    vec3 to_cluster = way + shadow.moved;
    float d = length(to_cluster);
    // Receivers behind the cluster's plane, and in front of their VPL's, are compared with the map's rim, with less weight the farther
    // behind they lie. Otherwise VPLs of a curved surface, such as a column, would lose all receivers hidden from the representative.
    float above = -dot(cross(shadow.across, shadow.up), to_cluster), height = max(above, 0.0);
    // Confidence of the map. It is low for receivers nearer to the VPL than the representative is, where little comes between.
    float known = clamp(1.0 + 2.0 * above / max(d, 1e-12), 0.0, 1.0) * min(shadow.near * sqrt(squared), 1.0);
    vec2 lateral = -vec2(dot(shadow.across, to_cluster), dot(shadow.up, to_cluster));
    vec2 p = lateral / max(above < 0.0 ? length(lateral) : d + height, 1e-12);
    float size = float(maps_of.size);
    vec2 at = (p * 0.5 + 0.5) * size;
    // The depth of a sloped surface varies across a texel by at most the texel's width over the cosine.
    float cosine = max(dot(normal, to_cluster) / max(d, 1e-12), 0.05);
    float hidden = d * cosine - maps_of.bias * 2.0 / size * (d + height), unit = cosine * maps_of.far;
    if (BILINEAR) {
        at = clamp(at - 0.5, 0.0, size - 1.0);
        ivec2 low = ivec2(at);
        ivec2 high = min(low + 1, ivec2(maps_of.size - 1));
        int layer = shadow.layer;
        vec4 nearest = vec4(imageLoad(maps, ivec3(low, layer)).r, imageLoad(maps, ivec3(high.x, low.y, layer)).r,
                            imageLoad(maps, ivec3(low.x, high.y, layer)).r, imageLoad(maps, ivec3(high, layer)).r);
        vec4 open = vec4(greaterThanEqual(nearest * unit, vec4(hidden)));
        vec2 within = at - vec2(low);
        vec2 rows = mix(open.xz, open.yw, within.x);
        return mix(1.0, mix(rows.x, rows.y, within.y), known);
    }
    ivec2 texel = clamp(ivec2(at), ivec2(0), ivec2(maps_of.size - 1));
    return imageLoad(maps, ivec3(texel, shadow.layer)).r * unit >= hidden ? 1.0 : 1.0 - known;
}
