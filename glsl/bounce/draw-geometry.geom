#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Sends a triangle to the maps of eight clusters, an invocation each (Aranha et al., section III-C). An instance of the draw is for one
// group of eight.
#include "bounce/map.glsl"

layout(triangles, invocations = 8) in;
layout(triangle_strip, max_vertices = 3) out;

layout(location = 0) in vec3 in_world[];
layout(location = 1) in vec2 in_uv[];
layout(location = 2) in vec4 in_color[];
layout(location = 3) flat in uint in_group[];

layout(location = 0) out vec3 out_local;
layout(location = 1) out vec2 out_uv;
layout(location = 2) out vec4 out_color;
layout(location = 3) flat out uint out_cluster;

layout(scalar, push_constant) uniform Params {
    float far;
    float texel_size;
    float albedo_lod;
    uint layer;
    uint layers;
} params;

layout(scalar) readonly buffer Clusters { VplCluster at[]; } clusters;

in gl_PerVertex { vec4 gl_Position; } gl_in[];
out gl_PerVertex {
    vec4 gl_Position;
    float gl_ClipDistance[1];
};

void main() {
    uint layer = in_group[0] * 8u + uint(gl_InvocationID);
    if (layer >= params.layers) return;
    VplCluster cluster = clusters.at[layer];
    vec3 local[3];
    for (int i = 0; i < 3; i++) local[i] = map_space(cluster, in_world[i]);
    float least = LEAST_HEIGHT * params.far;
    // Culled: behind the cluster's plane, or a cluster without members.
    if (max(max(local[0].z, local[1].z), local[2].z) <= least || cluster.members == 0u) return;
    for (int i = 0; i < 3; i++) {
        gl_Layer = int(layer);
        gl_Position = map_clip(local[i], params.far);
        gl_ClipDistance[0] = local[i].z - least;
        out_local = local[i];
        out_uv = in_uv[i];
        out_color = in_color[i];
        out_cluster = layer;
        EmitVertex();
    }
}
