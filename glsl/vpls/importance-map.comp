#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
// Importance map (Barak et al. 2013, section 4.1; a Bidirectional Reflective Shadow Map of Ritschel et al. 2011): the importance of every
// texel of the reflective shadow maps. An invocation has four texels.
#include "part/importance=vpls/importance-none"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params { uvec2 size; } params; // texels of a map

layout(r32f) writeonly uniform image2DArray importance;

void main() {
    ivec3 first = ivec3(gl_GlobalInvocationID.xy * 2u, gl_GlobalInvocationID.z), most = ivec3(params.size - 1u, first.z);
    // The whole workgroup takes part, also beyond the map.
    ivec3 a = first, b = first + ivec3(1, 0, 0), c = first + ivec3(0, 1, 0), d = first + ivec3(1, 1, 0);
    vec4 found = importances(min(a, most), min(b, most), min(c, most), min(d, most), params.size);
    if (all(lessThanEqual(a, most))) imageStore(importance, a, vec4(found.x));
    if (all(lessThanEqual(b, most))) imageStore(importance, b, vec4(found.y));
    if (all(lessThanEqual(c, most))) imageStore(importance, c, vec4(found.z));
    if (all(lessThanEqual(d, most))) imageStore(importance, d, vec4(found.w));
}
