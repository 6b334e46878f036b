#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
// Pixels see a VPL where the map of its cluster has nothing nearer (Aranha et al., section III-C).
#include "gather/clusters.glsl"
#include "gather/stochastic-tiled.glsl"

uvec4 seen(ivec2 pixel, uint index) { return uvec4(~0u); }
