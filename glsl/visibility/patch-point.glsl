// Inputs of the geometry stage, and the point made from a small triangle.
#include "lib/scene.glsl"
#include "visibility/point.glsl"
#include "visibility/patch-params.glsl"

layout(constant_id = 0) const bool THIN = false;

layout(triangles) in;
layout(location = 0) in vec3 position[];
layout(location = 1) in vec3 place[];
layout(location = 2) flat in uvec4 triangle[];
layout(location = 3) flat in uvec2 part[];

layout(scalar) readonly buffer Draws { DrawData at[]; } draws;

// Point of the small triangle, and its hash; false if there is none.
bool small_triangles_point(out Point point, out uvec2 hash) {
    vec3 normal = cross(position[1] - position[0], position[2] - position[0]);
    float area = length(normal);
    if (!(area > 0.0)) return false;
    normal /= area;
    // Ninths of a segment, as whole numbers, so that rounding does not change the hash.
    uvec3 ninths = uvec3(round((place[0] + place[1] + place[2]) * (3.0 * float(part[0].y))));
    hash = point_hash(triangle[0].xyz, triangle[0].w, part[0].x, ninths, params.seed);
    area = point_area(0.5 * area, params.max_area, hash.y, THIN);
    if (!(area > 0.0)) return false;
    bool double_sided = draws.at[triangle[0].w].double_sided != 0u;
    point = make_point((position[0] + position[1] + position[2]) / 3.0, normal, area, params.diagonal, double_sided);
    return true;
}
