#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Culling of the scene's parts by VPL clusters: one instance for each cluster that a part reaches into the hemisphere of, or for each group
// with such a cluster. Geometry behind a cluster's plane is not in its map.
#include "bounce/vpl-cluster.glsl"
#include "bounce/limits.glsl"
#include "lib/packing.glsl"
#include "lib/scene.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint GROUP = 1;

layout(scalar, push_constant) uniform Params {
    uint parts;
    uint first;    // first cluster
    uint clusters;
    float far;     // metres
    uint all;      // not 0 to draw everything
} params;

struct Arguments {
    uint index_count;
    uint instance_count;
    uint first_index;
    int vertex_offset;
    uint first_instance;
};

layout(scalar) readonly buffer Clusters { VplCluster at[]; } clusters;
layout(scalar) readonly buffer Parts { PartData at[]; } parts;
layout(scalar) buffer ArgumentsOfParts { Arguments at[]; } arguments;
layout(scalar) writeonly buffer Layers { uint at[]; } layers; // cluster or group of each instance of a part

void main() {
    uint part = gl_GlobalInvocationID.x;
    if (part >= params.parts) return;
    vec3 middle = 0.5 * (parts.at[part].box_min + parts.at[part].box_max), reach = parts.at[part].box_max - middle;
    uint count = 0u;
    for (uint begin = params.first; begin < params.first + params.clusters; begin += GROUP) {
        bool seen = params.all != 0u;
        for (uint k = begin; k < min(begin + GROUP, params.first + params.clusters); k++) {
            VplCluster cluster = clusters.at[k];
            vec3 n = octahedral_snorm16_inverse(cluster.normal);
            // Height of the box's corner that is farthest along the normal.
            float height = dot(n, middle - cluster.position) + dot(abs(n), reach);
            seen = seen || (cluster.members > 0u && height > LEAST_HEIGHT * params.far);
        }
        if (seen) {
            layers.at[part * params.clusters + count] = begin / GROUP;
            count++;
        }
    }
    arguments.at[part].instance_count = count;
}
