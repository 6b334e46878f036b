#version 460
#extension GL_ARB_shader_viewport_layer_array : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Vertex in a light's shadow map.
#include "lib/light.glsl"
#include "lib/scene.glsl"

// A single light's parameters are uniform over all vertices, which drivers exploit.
layout(constant_id = 0) const bool SEVERAL_LIGHTS = true;
layout(constant_id = 5) const bool VERTEX_COLOR = false;

layout(location = 0) in vec3 position;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 color;

layout(location = 0) out vec2 out_uv;
layout(location = 1) out float out_alpha;

layout(scalar) uniform LightsBlock { Light at[MAX_LIGHTS]; } lights;
layout(scalar) readonly buffer Draws { DrawData at[]; } draws;

out gl_PerVertex { vec4 gl_Position; };

void main() {
    // One instance a light, each in that light's layer.
    uint layer = 0u;
    if (SEVERAL_LIGHTS) layer = gl_InstanceIndex - gl_BaseInstance;
    vec3 world = draws.at[gl_BaseInstance].transform * vec4(position, 1.0);
    gl_Layer = int(layer);
    gl_Position = lights.at[layer].world_to_clip * vec4(world, 1.0);
    out_uv = uv;
    out_alpha = VERTEX_COLOR ? color.a : 1.0;
}
