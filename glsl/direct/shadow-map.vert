#version 460
#extension GL_ARB_shader_viewport_layer_array : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "rsm/vertex.glsl"

void main() { put_vertex(draws.at[gl_BaseInstance].transform); }
