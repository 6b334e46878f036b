#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Conservative rasterization in the shader (Hasselgren et al. 2005): a triangle of a hull, clipped at the near plane, is drawn as its
// bounding rectangle of tiles; the fragment shader tests its edges.
#include "gather/shell.glsl"
#include "gather/shell-triangle.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 4) out;

layout(location = 0) in vec3 in_point[];
layout(location = 1) in vec3 in_centre[];
layout(location = 2) flat in uint in_vpl[];

layout(location = 0) flat out vec3 out_edges[4]; // (x, y) in tiles is inside if no dot product with (x, y, 1) is negative
layout(location = 4) flat out vec3 out_plane;    // as in ShellTriangle
layout(location = 5) flat out vec2 out_range;
layout(location = 6) flat out uvec2 out_vpl;     // VPL, and whether it is on the far side

out gl_PerVertex { vec4 gl_Position; };

void main() {
    if (in_vpl[0] == 0xffffffffu) return;
    // At most four corners remain beyond the near plane.
    vec3 corners[4];
    int count = 0;
    float near = view.it.near;
    for (int i = 0; i < 3; i++) {
        vec3 a = in_point[i], b = in_point[(i + 1) % 3];
        if (a.z >= near) corners[count++] = a;
        if ((a.z >= near) != (b.z >= near)) corners[count++] = mix(a, b, (near - a.z) / (b.z - a.z));
    }
    if (count < 3) return;
    uvec2 set = set_of(in_vpl[0]), tiles = sorted_tiles();
    vec2 origin = vec2(set * tiles), places[4], low = vec2(1e30), high = vec2(-1e30);
    for (int i = 0; i < 4; i++) {
        vec3 corner = corners[min(i, count - 1)];
        places[i] = sorted_place(corner, set) / (corner.z * float(SHELL_TILE));
        low = min(low, places[i]);
        high = max(high, places[i]);
    }
    if (any(lessThan(high, vec2(0.0))) || any(greaterThan(low, vec2(tiles)))) return;

    vec2 middle = (places[0] + places[1] + places[2]) / 3.0;
    vec3 edges[4];
    for (int i = 0; i < 4; i++) {
        vec2 a = places[i], b = places[(i + 1) % 4], along = b - a;
        vec3 edge = vec3(-along.y, along.x, dot(a, vec2(along.y, -along.x)));
        if (dot(edge, vec3(middle, 1.0)) < 0.0) edge = -edge;
        // Relative to all pictures, as fragments are.
        edge.z -= dot(edge.xy, origin);
        edges[i] = edge;
    }
    ShellTriangle triangle = shell_triangle(in_point[0], in_point[1], in_point[2], in_centre[0], set);
    low = max(low, 0.0) + origin - 0.501;
    high = min(high, vec2(tiles)) + origin + 0.501;
    vec2 all = vec2(tiles * block_size());
    for (int i = 0; i < 4; i++) {
        vec2 place = vec2((i & 1) == 0 ? low.x : high.x, (i & 2) == 0 ? low.y : high.y);
        out_edges = edges;
        out_plane = triangle.plane;
        out_range = triangle.range;
        out_vpl = uvec2(in_vpl[0], uint(triangle.behind));
        gl_Position = vec4(place / all * 2.0 - 1.0, 0.5, 1.0);
        EmitVertex();
    }
    EndPrimitive();
}
