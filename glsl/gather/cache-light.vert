#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "gather/vertex-light.glsl"
#include "lib/scene.glsl"
#include "lib/view.glsl"
#include "part/proxies=gather/proxies-one"

layout(constant_id = 5) const bool VERTEX_COLOR = false;
layout(constant_id = 6) const uint SIDES = 1u;

layout(location = 0) in vec3 position;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 color;

layout(location = 0) out vec2 out_uv;
layout(location = 1) out float out_alpha;
layout(location = 2) out vec4 out_place[2u * PROXIES];
layout(location = 6) out vec4 out_flux[2u * PROXIES]; // and the lit share

layout(scalar) uniform ViewBlock { View it; } view;
layout(scalar) readonly buffer Draws { DrawData at[]; } draws;
layout(scalar) readonly buffer Firsts { uint at[]; } firsts; // of the draws' vertex lights, less the first vertex
layout(scalar) readonly buffer Lights { VertexLight at[]; } vertex_lights;

out gl_PerVertex { vec4 gl_Position; };

void main() {
    gl_Position = view.it.view_projection * vec4(draws.at[gl_BaseInstance].transform * vec4(position, 1.0), 1.0);
    out_uv = uv;
    out_alpha = VERTEX_COLOR ? color.a : 1.0;
    uint number = (firsts.at[gl_BaseInstance] + uint(gl_VertexIndex)) * SIDES * PROXIES;
    for (uint i = 0u; i < 2u * PROXIES; i++) {
        out_place[i] = vec4(0.0);
        out_flux[i] = vec4(0.0);
        if (i < SIDES * PROXIES) {
            VertexLight light = vertex_lights.at[number + i];
            out_place[i] = vec4(light.way, light.extent);
            out_flux[i] = vec4(light.flux, light.lit);
        }
    }
}
