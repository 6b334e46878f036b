#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Splats (Linke 2016, section 4.4.2): the point of a small triangle is drawn as a square into the maps of the first VPLs that can see it,
// among those that it is tested against.
#include "lib/basis.glsl"
#include "lib/vpl.glsl"
#include "visibility/ism.glsl"
#include "visibility/patch-point.glsl"

layout(constant_id = 1) const uint MAP_SIZE = 64;
layout(constant_id = 2) const bool DISTORTION = true;

#include "part/projection=visibility/projection-paraboloid"

layout(scalar) uniform SplatBlock {
    ivec2 size;      // of the image of all maps
    uint columns;
    uint considered; // VPLs a point is tested against
    uint collected;  // VPLs that a point is drawn for, at most
    float far;       // metres
    float enlarge;
} splat;

layout(scalar) readonly buffer Places { VplPlace at[]; } places;

#include "part/most=visibility/most-one"
layout(location = 0) flat out ivec2 corner;
out gl_PerVertex {
    vec4 gl_Position;
    float gl_PointSize;
};

bool sees(Point point, vec3 normal, VplPlace vpl) {
    vec3 facing = octahedral_snorm16_inverse(vpl.normal);
    return is_in_the_way(point, normal, sight(point.position - vpl.position, facing), facing);
}

void main() {
    Point point;
    uvec2 hash;
    if (!small_triangles_point(point, hash)) return;
    uint first = hashed_index(hash.x, params.partitions);
    vec3 normal = point_normal(point);
    uint passing = 0u;
    for (uint k = 0u; k < splat.considered; k++) passing += uint(sees(point, normal, places.at[(first + k) % params.partitions]));
    uint rest = min(passing, splat.collected);
    if (rest == 0u) return;
    float radius = point_radius(point, params.diagonal) * splat.enlarge * point_enlargement(params.partitions, splat.considered, passing, rest);
    for (uint k = 0u; k < splat.considered && rest > 0u; k++) {
        uint index = (first + k) % params.partitions;
        VplPlace vpl = places.at[index];
        if (!sees(point, normal, vpl)) continue;
        rest--;
        vec3 from = point.position - vpl.position;
        mat3 axes = basis_of(octahedral_snorm16_inverse(vpl.normal));
        vec3 way = sight(from, axes[2]);
        float d = length(way);
        vec3 w = way * axes / d;
        float seen_radius = DISTORTION ? radius * sqrt(abs(dot(normal, way)) / d) : radius;
        // Side of a square of the disk's area.
        float side = sqrt(PI) * radius_in_map(index, seen_radius, d, w.z) * (0.5 * float(MAP_SIZE));
        corner = map_corner(index, splat.columns, int(MAP_SIZE));
        vec2 texel = vec2(corner) + clamp((place_in_map(index, from, w) * 0.5 + 0.5) * float(MAP_SIZE), vec2(0.01), vec2(float(MAP_SIZE) - 0.01));
        gl_Position = vec4(texel / vec2(splat.size) * 2.0 - 1.0, 1.0 - min(d / splat.far, 1.0), 1.0);
        gl_PointSize = clamp(side, 1.0, float(MAP_SIZE));
        EmitVertex();
        EndPrimitive();
    }
}
