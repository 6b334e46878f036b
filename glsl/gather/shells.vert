#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Hull of a VPL's range, in view space.
#include "gather/bounds.glsl"
#include "gather/shell.glsl"

layout(location = 0) in vec3 position; // around the unit sphere

layout(location = 0) out vec3 out_point;
layout(location = 1) out vec3 out_centre;
layout(location = 2) flat out uint out_vpl; // all bits set for an empty range

void main() {
    uint index = gl_InstanceIndex;
    out_point = vec3(0.0);
    out_centre = vec3(0.0);
    out_vpl = on_bounds(index, position, out_point, out_centre) ? index : 0xffffffffu;
}
