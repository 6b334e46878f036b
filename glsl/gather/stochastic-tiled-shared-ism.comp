#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
// Pixels see a VPL where the imperfect shadow map of its neighbour has nothing nearer (Linke 2016, section 3.3).
#include "gather/shared-ism.glsl"
#include "gather/stochastic-tiled.glsl"

uvec4 seen(ivec2 pixel, uint index) { return uvec4(~0u); }
