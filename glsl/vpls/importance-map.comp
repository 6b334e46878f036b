#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Importance map (Barak et al. 2013, section 4.1; a Bidirectional Reflective Shadow Map of Ritschel et al. 2011): the importance of every
// texel of the reflective shadow maps. An invocation has 4 x 4 texels.
#include "part/importance=vpls/importance-none"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params { uvec2 size; } params; // texels of a map

layout(r32f) writeonly uniform image2DArray importance;

void main() {
    ivec3 first = ivec3(gl_GlobalInvocationID.xy * 4u, gl_GlobalInvocationID.z), most = ivec3(params.size - 1u, first.z);
    ivec3 at[AT_ONCE];
    for (uint k = 0u; k < AT_ONCE; k++) at[k] = min(first + ivec3(k & 3u, k >> 2u, 0), most);
    float found[AT_ONCE];
    importances(at, params.size, found);
    for (uint k = 0u; k < AT_ONCE; k++) {
        ivec3 own = first + ivec3(k & 3u, k >> 2u, 0);
        if (all(lessThanEqual(own, most))) imageStore(importance, own, vec4(found[k]));
    }
}
