// A triangle of a VPL's bounds as the tiles of its set's picture see it.
#include "gather/shell-froxel.glsl"

struct ShellTriangle {
    vec3 plane;  // (x, y, 1), a place in tiles of all pictures, times this is one over the distance; zeros if it is seen from its edge
    vec2 range;  // of one over the distance, of what lies beyond the near plane
    bool behind; // on the far side
};

uvec2 sorted_tiles() { return (sorted_size() + SHELL_TILE - 1u) / SHELL_TILE; }

// Of three corners, and the middle of what it bounds, in the view's space.
ShellTriangle shell_triangle(vec3 a, vec3 b, vec3 c, vec3 centre, uvec2 set) {
    vec3 normal = cross(b - a, c - a);
    float offset = dot(normal, a);
    ShellTriangle triangle;
    // The eye is at 0: a side that does not part it from the middle is a far one.
    triangle.behind = (offset - dot(normal, centre)) * offset >= 0.0;
    float near = view.it.near, nearest = min(a.z, min(b.z, c.z)), farthest = max(a.z, max(b.z, c.z));
    triangle.range = 1.0 / max(vec2(farthest, nearest), near);
    // One over the distance is linear in the picture.
    triangle.plane = vec3(0.0);
    if (abs(offset) > 1e-6 * length(normal) * length(a)) {
        vec2 size = vec2(view.it.width, view.it.height), tangents = vec2(length(view.it.right), length(view.it.up));
        // Tangents to the sides from a place in tiles: t = scale * place + shift.
        vec2 scale = 2.0 * float(SHELL_TILE * INTERLEAVE) / size;
        vec2 shift = 2.0 * (vec2(set) + 0.5 - 0.5 * float(INTERLEAVE)) / size - 1.0;
        vec2 ways = vec2(normal.x * tangents.x, -normal.y * tangents.y);
        triangle.plane = vec3(ways * scale, dot(ways, shift) + normal.z) / offset;
        triangle.plane.z -= dot(triangle.plane.xy, vec2(set * sorted_tiles()));
    }
    return triangle;
}
