#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Solid angle of the scene that each VPL sees, without occlusion: a workgroup a VPL.
#include "lib/packing.glsl"
#include "lib/vpl.glsl"
#include "visibility/point-cluster.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    uint clusters;
} params;

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Areas { float at[]; } areas; // 0 of VPLs that are dark
layout(scalar) readonly buffer Clusters { PointCluster at[]; } clusters;
layout(scalar) writeonly buffer Views { float at[]; } views; // solid angles, 0 for VPLs without light

shared float totals[64];

void main() {
    uint vpl = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    vec3 position = places.at[vpl].position;
    vec3 normal = octahedral_snorm16_inverse(places.at[vpl].normal);
    bool dark = areas.at[vpl] == 0.0;
    float sum = 0.0;
    for (uint i = lane; i < params.clusters && !dark; i += 64u) sum += cluster_view(clusters.at[i], position, normal);
    totals[lane] = sum;
    barrier();
    if (lane > 0u) return;
    float total = 0.0;
    for (uint i = 0u; i < 64u; i++) total += totals[i];
    views.at[vpl] = total;
}
