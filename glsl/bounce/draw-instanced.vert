#version 460
#extension GL_ARB_shader_viewport_layer_array : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The scene for all clusters: an instance each.
#include "bounce/placed.glsl"

uint layer_of() { return gl_InstanceIndex - gl_BaseInstance; }
