// Sorted pictures: one for each of the n x n sample sets, side by side, into which the bounding geometry of VPLs' ranges is drawn (Tokuyoshi and Harada
// 2017, figure 8).
#include "lib/view.glsl"

layout(constant_id = 0) const uint INTERLEAVE = 1;

layout(scalar) uniform ViewBlock { View it; } view;

uvec2 set_of(uint index) {
    uint set = index % (INTERLEAVE * INTERLEAVE);
    return uvec2(set % INTERLEAVE, set / INTERLEAVE);
}

// Pixels of a sorted picture.
uvec2 sorted_size() { return (uvec2(view.it.width, view.it.height) + INTERLEAVE - 1u) / INTERLEAVE; }

// Where in a set's picture a point (x, y, distance) lies, in its pixels, times the distance.
vec2 sorted_place(vec3 point, uvec2 set) {
    vec2 size = vec2(view.it.width, view.it.height), tangents = vec2(length(view.it.right), length(view.it.up));
    vec2 full = 0.5 * (vec2(point.x, -point.y) / tangents + point.z) * size;
    return (full - (vec2(set) + 0.5) * point.z) / float(INTERLEAVE) + 0.5 * point.z;
}
