// Hulls of VPLs' ranges: of the spheres of diffuse VPLs, or the spheroids of glossy ones.
#include "lib/range.glsl"

layout(constant_id = 1) const bool GLOSSY = false; // whether the VPLs are glossy

layout(scalar) readonly buffer Spheres { vec4 at[]; } spheres;
layout(scalar) readonly buffer Spheroids { Spheroid at[]; } spheroids;

// Maps a point around the unit sphere to the range of VPL `index`, in view space; false if the range is empty.
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
