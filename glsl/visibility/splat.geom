#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Splats of small triangles.
#include "visibility/patch-point.glsl"
#include "visibility/splat.glsl"

#include "part/most=visibility/most-one"
out gl_PerVertex {
    vec4 gl_Position;
    float gl_PointSize;
};

void main() {
    Point point;
    uvec4 hash;
    if (!small_triangles_point(point, hash)) return;
    uint first = hashed_index(hash.x, params.partitions);
    vec3 normal = point_normal(point);
    uint passing = passing_vpls(point, normal, first, params.partitions);
    uint rest = min(passing, splat.collected);
    if (rest == 0u) return;
    float radius = point_radius(point, params.diagonal) * splat.enlarge * point_enlargement(params.partitions, splat.considered, passing, rest);
    for (uint k = 0u; k < splat.considered && rest > 0u; k++) {
        uint index = (first + k) % params.partitions;
        if (!sees(point, normal, places.at[index])) continue;
        rest--;
        Square square = square_of(point, normal, radius, index);
        corner = square.corner;
        gl_Position = square.position;
        gl_PointSize = square.side;
        put_plane(square);
        EmitVertex();
        EndPrimitive();
    }
}
