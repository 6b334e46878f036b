#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Direct light without shadows.
#include "direct/shadow-map.glsl"

float shadow(Light light, uint layer, vec2 uv, float distance) { return 1.0; }
