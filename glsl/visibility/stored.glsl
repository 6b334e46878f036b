// Points that were stored once, on the triangles as they are now: src/stages/visibility/stored.rs.
#include "lib/scene.glsl"
#include "visibility/point.glsl"
#include "part/mask=visibility/mask-none"

struct StoredTriangle {
    uvec3 corners;
    uint draw;
    float share; // of the triangle's area that each of its points stands for
};

layout(scalar) readonly buffer Triangles { StoredTriangle at[]; } triangles;
layout(scalar) readonly buffer Draws { DrawData at[]; } draws;
layout(scalar) readonly buffer Positions { vec3 at[]; } positions;

// Point of a record: its triangle, and the weights of the second and third corner, 16 bits each. It is empty in a hole, and where the
// triangle has no area.
Point stored_point(uvec2 record, float diagonal) {
    Point empty = Point(vec3(0.0), 0u);
    StoredTriangle triangle = triangles.at[record.x];
    mat4x3 transform = draws.at[triangle.draw].transform;
    mat3 world;
    for (uint i = 0u; i < 3u; i++) world[i] = transform * vec4(positions.at[triangle.corners[i]], 1.0);
    vec3 normal = cross(world[1] - world[0], world[2] - world[0]);
    float area = length(normal);
    if (!(area > 0.0)) return empty;
    vec2 weights = vec2(record.y & 0xffffu, record.y >> 16u) / 65535.0;
    vec3 at = vec3(1.0 - weights.x - weights.y, weights);
    uint material = draws.at[triangle.draw].material;
    if (is_masked(material) && is_hole(material, triangle.corners, at)) return empty;
    bool double_sided = draws.at[triangle.draw].double_sided != 0u;
    // All points have about the same area: they are rounded up and down at random, or their sum would be off by the rounding of one.
    float rounding = float((record.y * 2654435761u) >> 8u) / 16777216.0;
    return make_point_rounded(world * at, normal / area, 0.5 * area * triangle.share, diagonal, double_sided, rounding);
}
