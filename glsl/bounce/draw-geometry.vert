#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// World positions of vertices; the geometry stage sends triangles to the clusters.
#include "bounce/vertex.glsl"

layout(location = 0) out vec3 out_world;
layout(location = 1) out vec2 out_uv;
layout(location = 2) out vec4 out_color;
layout(location = 3) flat out uint out_group;

layout(scalar) readonly buffer Layers { uint at[]; } layers; // group of each instance of a part

out gl_PerVertex { vec4 gl_Position; };

void main() {
    out_world = draws.at[parts.at[gl_BaseInstance].draw].transform * vec4(position, 1.0);
    out_uv = uv;
    out_color = vec4(1.0);
    if (VERTEX_COLOR) out_color = color;
    out_group = layers.at[gl_BaseInstance * params.layers + gl_InstanceIndex - gl_BaseInstance];
    gl_Position = vec4(0.0);
}
