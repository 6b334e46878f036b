#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "lib/packing.glsl"
#include "lib/scene.glsl"
#include "lib/view.glsl"

layout(constant_id = 0) const bool NORMAL_MAP = false;
layout(constant_id = 5) const bool VERTEX_COLOR = false;

layout(location = 0) in vec3 position;
layout(location = 1) in vec2 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 color;
layout(location = 4) in uint tangent;

layout(location = 0) out vec3 out_normal;
layout(location = 1) out vec2 out_uv;
layout(location = 2) out vec4 out_color;
layout(location = 3) out vec4 out_tangent;

layout(scalar) uniform ViewBlock { View it; } view;
layout(scalar) readonly buffer Draws { DrawData at[]; } draws;

out gl_PerVertex { vec4 gl_Position; };

void main() {
    mat4x3 transform = draws.at[gl_BaseInstance].transform;
    mat3 linear = mat3(transform);
    // The cofactor matrix transforms normals under any scale; the sign is the transform's own.
    mat3 cofactor = mat3(cross(linear[1], linear[2]), cross(linear[2], linear[0]), cross(linear[0], linear[1]));
    float orientation = dot(linear[0], cofactor[0]) < 0.0 ? -1.0 : 1.0;
    gl_Position = view.it.view_projection * vec4(transform * vec4(position, 1.0), 1.0);
    out_normal = cofactor * octahedral_inverse(normal) * orientation;
    out_uv = uv;
    out_color = vec4(1.0);
    if (VERTEX_COLOR) out_color = color;
    out_tangent = vec4(0.0);
    if (NORMAL_MAP) {
        vec4 t = tangent_inverse(tangent);
        // Mirrored draws have handedness and triangles flipped on the host.
        out_tangent = vec4(linear * t.xyz, t.w);
    }
}
