#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Splats of stored points: instance k of a point is drawn into the k-th map that it is collected for.
#include "visibility/splat.glsl"
#include "visibility/stored.glsl"

layout(scalar, push_constant) uniform Params {
    float diagonal;   // of the scene's bounds, metres
    uint partitions;  // VPLs
    uint first;       // VPL of the first points
    uint spacing;     // of points, in units of 2^-32 of all points of the buffer
} params;

layout(location = 0) in uint triangle;
layout(location = 1) in uint weights;

out gl_PerVertex {
    vec4 gl_Position;
    float gl_PointSize;
};

void main() {
    // Beyond the depth's range, where nothing is drawn.
    gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
    gl_PointSize = 1.0;
    corner = ivec2(0);
    Point point = stored_point(uvec2(triangle, weights), params.diagonal);
    if (point_is_empty(point)) return;
    uint first = hashed_index(uint(gl_VertexIndex) * params.spacing, params.partitions) + params.first;
    vec3 normal = point_normal(point);
    uint passing = passing_vpls(point, normal, first, params.partitions);
    uint rest = min(passing, splat.collected), instance = uint(gl_InstanceIndex);
    if (instance >= rest) return;
    float radius = point_radius(point, params.diagonal) * splat.enlarge * point_enlargement(params.partitions, splat.considered, passing, rest);
    uint seen = 0u;
    for (uint k = 0u; k < splat.considered; k++) {
        uint index = (first + k) % params.partitions;
        if (!sees(point, normal, places.at[index]) || seen++ < instance) continue;
        Square square = square_of(point, normal, radius, index);
        corner = square.corner;
        gl_Position = square.position;
        gl_PointSize = square.side;
        put_plane(square);
        return;
    }
}
