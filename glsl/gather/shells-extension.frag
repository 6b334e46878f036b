#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Tiles that a triangle touches, found by the device's conservative rasterization.
#include "gather/shell.glsl"
#include "gather/shell-mark.glsl"

layout(location = 0) flat in vec3 in_plane;
layout(location = 1) flat in vec2 in_range;
layout(location = 2) flat in uvec2 in_vpl;

layout(location = 0) out float touched;

void main() {
    touched = 1.0;
    uvec2 tile = uvec2(gl_FragCoord.xy);
    if (in_set(tile, in_vpl.x)) mark(tile, in_plane, in_range, in_vpl);
}
