#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Shadow rays between pixels and virtual point lights: an invocation traces those of one pixel and 32 VPLs. Pixels share the VPLs as in
// glsl/gather/per-pixel.glsl.
#include "lib/interleave.glsl"
#include "lib/vpl.glsl"
#include "visibility/shadow-ray.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(scalar, push_constant) uniform Params {
    uint count; // VPLs
} params;

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Areas { float at[]; } areas; // 0 of VPLs that are dark
layout(r32ui) writeonly uniform uimage2DArray visible;

void main() {
    uvec2 set = gl_WorkGroupID.xy % block_size();
    uvec2 block = gl_WorkGroupID.xy / block_size() * gl_WorkGroupSize.xy * block_size();
    ivec2 pixel = ivec2(block + gl_LocalInvocationID.xy * block_size() + set);
    if (!in_picture(pixel)) return;
    Receiver r = receiver(pixel);
    uint bits = 0u;
    if (r.distance > 0.0) {
        vec3 from = ray_start(r);
        for (uint i = 0u; i < 32u; i++) {
            uint index = (gl_WorkGroupID.z * 32u + i) * SETS + number_of(set);
            if (index >= params.count) break;
            VplPlace vpl = places.at[index];
            vec3 facing = octahedral_snorm16_inverse(vpl.normal);
            vec3 way = vpl.position - r.position;
            // Traced only if light would arrive.
            if (dot(r.normal, way) > 0.0 && dot(facing, way) < 0.0 && areas.at[index] > 0.0) {
                bits |= reaches(from, vpl.position, facing) ? 1u << i : 0u;
            }
        }
    }
    imageStore(visible, ivec3(pixel, gl_WorkGroupID.z), uvec4(bits));
}
