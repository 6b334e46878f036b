// World-space corner of a triangle, and ids of its triangle and part: primitive numbers are unreliable in the tessellation stages of some
// drivers.
#include "lib/scene.glsl"

layout(location = 0) in vec3 position;

layout(location = 0) out vec3 out_position;
layout(location = 1) flat out uvec3 out_ids; // of the vertex, the draw and the part

layout(scalar) readonly buffer Draws { DrawData at[]; } draws;

void main() {
    out_position = draws.at[gl_BaseInstance].transform * vec4(position, 1.0);
    out_ids = uvec3(gl_VertexIndex, gl_BaseInstance, gl_InstanceIndex - gl_BaseInstance);
}
