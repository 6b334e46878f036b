#version 460
#extension GL_ARB_shader_viewport_layer_array : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "lib/packing.glsl"
#include "rsm/vertex.glsl"

layout(location = 3) in vec2 normal;
layout(location = 3) out vec3 out_normal;

void main() {
    mat4x3 transform = draws.at[gl_BaseInstance].transform;
    put_vertex(transform);
    mat3 linear = mat3(transform);
    // The cofactor matrix transforms normals under any scale; the sign is the transform's own.
    mat3 cofactor = mat3(cross(linear[1], linear[2]), cross(linear[2], linear[0]), cross(linear[0], linear[1]));
    out_normal = cofactor * octahedral_inverse(normal) * (dot(linear[0], cofactor[0]) < 0.0 ? -1.0 : 1.0);
}
