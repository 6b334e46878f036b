// Tessellation level of a triangle, or of a part of one, by its area (Linke 2016, section 4.4.1).
#include "visibility/point.glsl"
#include "visibility/sizes.glsl"

layout(vertices = 3) out;

layout(location = 0) in vec3 position[];
layout(location = 1) flat in uvec3 ids[];

layout(location = 0) out vec3 out_position[];
layout(location = 1) patch out uvec4 out_triangle; // vertices and draw
layout(location = 2) patch out uvec2 out_part;     // number of the part; level, and split in the bits from 8 on

void main() {
    vec3 a = position[0], b = position[1], c = position[2];
    float area = 0.5 * length(cross(b - a, c - a));
    Subdivision parts = subdivision(area, sizes.max_area);
    uint part = ids[0].z;
    bool there = area > 0.0 && part < parts.split * parts.split;
    uvec3 place[3] = uvec3[](uvec3(1u, 0u, 0u), uvec3(0u, 1u, 0u), uvec3(0u, 0u, 1u));
    if (there && parts.split > 1u) sub_triangle(part, parts.split, place[0], place[1], place[2]);
    out_position[gl_InvocationID] = mat3(a, b, c) * (vec3(place[gl_InvocationID]) / float(there ? parts.split : 1u));
    if (gl_InvocationID == 0) {
        out_triangle = uvec4(ids[0].x, ids[1].x, ids[2].x, ids[0].y);
        out_part = uvec2(part, parts.level | parts.split << 8u);
        // Level 0 discards the patch.
        float level = there ? float(parts.level) : 0.0;
        gl_TessLevelInner[0] = level;
        gl_TessLevelOuter[0] = level;
        gl_TessLevelOuter[1] = level;
        gl_TessLevelOuter[2] = level;
    }
}
