// The bounding geometry of VPLs' ranges, drawn for pixels that are sorted by their sample sets: n x n pictures, each of every n-th pixel, side by
// side (Tokuyoshi and Harada 2017, figure 8).
#include "lib/range.glsl"
#include "lib/view.glsl"

layout(constant_id = 0) const uint INTERLEAVE = 1;
layout(constant_id = 1) const bool GLOSSY = false; // which of the two lists

layout(scalar) uniform ViewBlock { View it; } view;
layout(scalar) readonly buffer Spheres { vec4 at[]; } spheres;
layout(scalar) readonly buffer Spheroids { Spheroid at[]; } spheroids;

// A point of the unit sphere on the bounds of VPL number `index`, in the view's space; whether there are any.
bool on_bounds(uint index, vec3 unit, out vec3 point, out vec3 centre) {
    if (GLOSSY) {
        Spheroid it = spheroids.at[index];
        if (it.depth == 0.0) return false;
        mat3 back = inverse(transpose(mat3(it.row0, it.row1, vec3(0.0, 0.0, it.depth))));
        point = back * (it.centre + unit);
        centre = back * it.centre;
        return true;
    }
    vec4 sphere = spheres.at[index];
    point = sphere.xyz + sphere.w * unit;
    centre = sphere.xyz;
    return sphere.w > 0.0;
}

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
