#version 460
#extension GL_ARB_shader_viewport_layer_array : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Projects a vertex into the map of one cluster.
#include "bounce/vertex.glsl"

layout(location = 0) out vec3 out_local;
layout(location = 1) out vec2 out_uv;
layout(location = 2) out vec4 out_color;
layout(location = 3) flat out uint out_cluster;

layout(scalar) readonly buffer Clusters { VplCluster at[]; } clusters;

out gl_PerVertex {
    vec4 gl_Position;
    float gl_ClipDistance[1];
};

#include "part/layer=bounce/layer-instance"

void main() {
    uint layer = layer_of();
    vec3 world = draws.at[parts.at[gl_BaseInstance].draw].transform * vec4(position, 1.0);
    vec3 local = map_space(clusters.at[layer], world);
    gl_Layer = int(layer);
    gl_Position = map_clip(local, params.far);
    gl_ClipDistance[0] = clusters.at[layer].members > 0u ? local.z - LEAST_HEIGHT * params.far : -1.0;
    out_local = local;
    out_uv = uv;
    out_color = vec4(1.0);
    if (VERTEX_COLOR) out_color = color;
    out_cluster = layer;
}
