#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// One map a point.
#include "visibility/splat.glsl"

layout(points, max_vertices = 1) out;
