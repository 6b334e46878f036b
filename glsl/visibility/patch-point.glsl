// Inputs of the geometry stage, and the point made from a small triangle.
#include "lib/scene.glsl"
#include "visibility/patch-params.glsl"
#include "visibility/point.glsl"
#include "visibility/small-corners.glsl"
#include "part/mask=visibility/mask-none"

layout(constant_id = 0) const bool THIN = false;

layout(triangles) in;
layout(location = 0) in vec3 position[];
layout(location = 1) in vec3 place[];
layout(location = 2) flat in uvec4 triangle[];
layout(location = 3) flat in uvec2 part[];

layout(scalar) readonly buffer Draws { DrawData at[]; } draws;

// Point of the small triangle, and its hash; false if there is none.
bool small_triangles_point(out Point point, out uvec4 hash) {
    vec3 normal = cross(position[1] - position[0], position[2] - position[0]);
    float area = length(normal);
    if (!(area > 0.0)) return false;
    normal /= area;
    uint level = part[0].y & 255u;
    // Ninths of a segment, as whole numbers, so that rounding does not change the hash.
    uvec3 ninths = uvec3(round((place[0] + place[1] + place[2]) * (3.0 * float(level))));
    hash = point_hash(triangle[0].xyz, triangle[0].w, part[0].x, ninths, params.seed);
    area = point_area(0.5 * area, sizes.max_area, hash.y, THIN);
    if (!(area > 0.0)) return false;
    vec3 middle = (position[0] + position[1] + position[2]) / 3.0;
    uint material = draws.at[triangle[0].w].material;
    if (is_masked(material)) {
        uvec3 thirds[3];
        for (uint i = 0u; i < 3u; i++) thirds[i] = uvec3(round(place[i] * (3.0 * float(level))));
        vec3 at = random_weights(thirds[0], thirds[1], thirds[2], hash.zw);
        middle = mat3(position[0], position[1], position[2]) * at;
        uint split = part[0].y >> 8u;
        uvec3 u = uvec3(1u, 0u, 0u), v = uvec3(0u, 1u, 0u), w = uvec3(0u, 0u, 1u);
        if (split > 1u) sub_triangle(part[0].x, split, u, v, w);
        vec3 within = mat3(vec3(thirds[0]), vec3(thirds[1]), vec3(thirds[2])) * at / float(3u * level);
        if (is_hole(material, triangle[0].xyz, mat3(vec3(u), vec3(v), vec3(w)) * within / float(split))) return false;
    }
    bool double_sided = draws.at[triangle[0].w].double_sided != 0u;
    point = make_point(middle, normal, area, params.diagonal, double_sided);
    return true;
}
