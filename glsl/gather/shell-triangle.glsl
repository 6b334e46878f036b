// A triangle of a VPL's hull, in the tiles of its sample set's picture.
#include "gather/shell-froxel.glsl"

struct ShellTriangle {
    vec3 plane;  // dot with (x, y, 1), in tiles of all pictures, is 1 / distance; zeros if seen edge-on
    vec2 range;  // range of 1 / distance beyond the near plane
    bool behind; // on the hull's far side
};

uvec2 sorted_tiles() { return (sorted_size() + SHELL_TILE - 1u) / SHELL_TILE; }

// Triangle from three corners and the centre of its hull, in view space.
ShellTriangle shell_triangle(vec3 a, vec3 b, vec3 c, vec3 centre, uvec2 set) {
    vec3 normal = cross(b - a, c - a);
    float offset = dot(normal, a);
    ShellTriangle triangle;
    // The eye is at 0: a side that does not separate it from the centre is a far side.
    triangle.behind = (offset - dot(normal, centre)) * offset >= 0.0;
    float near = view.it.near, nearest = min(a.z, min(b.z, c.z)), farthest = max(a.z, max(b.z, c.z));
    triangle.range = 1.0 / max(vec2(farthest, nearest), near);
    // 1 / distance is linear in the picture.
    triangle.plane = vec3(0.0);
    if (abs(offset) > 1e-6 * length(normal) * length(a)) {
        vec2 size = vec2(view.it.width, view.it.height), tangents = vec2(length(view.it.right), length(view.it.up));
        // Tangents from a position in tiles: t = scale * position + shift.
        vec2 scale = 2.0 * vec2(SHELL_TILE * block_size()) / size;
        vec2 shift = 2.0 * (vec2(set) + 0.5 - 0.5 * vec2(block_size())) / size - 1.0;
        vec2 ways = vec2(normal.x * tangents.x, -normal.y * tangents.y);
        triangle.plane = vec3(ways * scale, dot(ways, shift) + normal.z) / offset;
        triangle.plane.z -= dot(triangle.plane.xy, vec2(set * sorted_tiles()));
    }
    return triangle;
}
