// Pixels sorted by sample set: n x n pictures of every n-th pixel, side by side, into which hulls of VPLs' ranges are rasterized (Tokuyoshi
// and Harada 2017, figure 8).
#include "lib/view.glsl"

layout(constant_id = 0) const uint INTERLEAVE = 1;

layout(scalar) uniform ViewBlock { View it; } view;

uvec2 set_of(uint index) {
    uint set = index % (INTERLEAVE * INTERLEAVE);
    return uvec2(set % INTERLEAVE, set / INTERLEAVE);
}

// Size of one sample set's picture, pixels.
uvec2 sorted_size() { return (uvec2(view.it.width, view.it.height) + INTERLEAVE - 1u) / INTERLEAVE; }

// Position of a point (x, y, distance) in a set's picture, in pixels of it, times the distance.
vec2 sorted_place(vec3 point, uvec2 set) {
    vec2 size = vec2(view.it.width, view.it.height), tangents = vec2(length(view.it.right), length(view.it.up));
    vec2 full = 0.5 * (vec2(point.x, -point.y) / tangents + point.z) * size;
    return (full - (vec2(set) + 0.5) * point.z) / float(INTERLEAVE) + 0.5 * point.z;
}
