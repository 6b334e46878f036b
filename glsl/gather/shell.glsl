// Pixels sorted by sample set: pictures of every n-th pixel across and m-th down, side by side, into which hulls of VPLs' ranges are
// rasterized (Tokuyoshi and Harada 2017, figure 8).
#include "lib/interleave.glsl"
#include "lib/view.glsl"

layout(scalar) uniform ViewBlock { View it; } view;

uvec2 set_of(uint index) {
    uint set = index % SETS;
    return uvec2(set % BLOCK_ACROSS, set / BLOCK_ACROSS);
}

// Size of one sample set's picture, pixels.
uvec2 sorted_size() { return (uvec2(view.it.width, view.it.height) + block_size() - 1u) / block_size(); }

// Position of a point (x, y, distance) in a set's picture, in pixels of it, times the distance.
vec2 sorted_place(vec3 point, uvec2 set) {
    vec2 size = vec2(view.it.width, view.it.height), tangents = vec2(length(view.it.right), length(view.it.up));
    vec2 full = 0.5 * (vec2(point.x, -point.y) / tangents + point.z) * size;
    return (full - (vec2(set) + 0.5) * point.z) / vec2(block_size()) + 0.5 * point.z;
}
