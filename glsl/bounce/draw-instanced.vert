#version 460
#extension GL_ARB_shader_viewport_layer_array : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The scene for all clusters: an instance for each that sees a part of it.
#include "bounce/placed.glsl"

layout(scalar) readonly buffer Layers { uint at[]; } layers; // of each part's instances

uint layer_of() { return layers.at[gl_BaseInstance * params.layers + gl_InstanceIndex - gl_BaseInstance]; }
