#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Hull of a VPL's range, an instance a VPL (Dachsbacher and Stamminger 2006), in the picture of its sample set.
#include "gather/bounds.glsl"
#include "gather/shell.glsl"

layout(location = 0) in vec3 position; // around the unit sphere

layout(location = 0) flat out uint out_vpl;

out gl_PerVertex {
    vec4 gl_Position;
    float gl_ClipDistance[4];
};

void main() {
    uint index = gl_InstanceIndex;
    vec3 point, centre;
    out_vpl = index;
    gl_ClipDistance = float[4](0.0, 0.0, 0.0, 0.0);
    if (!on_bounds(index, position, point, centre)) {
        // Degenerate: an empty range.
        gl_Position = vec4(2.0, 2.0, 0.0, 1.0);
        return;
    }
    uvec2 set = set_of(index);
    vec2 size = vec2(sorted_size()), place = sorted_place(point, set);
    gl_Position = vec4((place + vec2(set) * size * point.z) * 2.0 / (size * vec2(block_size())) - point.z, view.it.near, point.z);
    gl_ClipDistance = float[4](place.x, size.x * point.z - place.x, place.y, size.y * point.z - place.y);
}
