#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Shadow rays to the sky: an invocation traces those of one pixel in 32 directions. Pixels share the directions as in
// glsl/gather/per-pixel.glsl.
#include "bvh/hole.glsl"
#include "gbuffer/receiver.glsl"
#include "lib/interleave.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(scalar, push_constant) uniform Params {
    uint count; // directions
} params;

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(r32ui) writeonly uniform uimage2DArray visible;

void main() {
    uvec2 set = gl_WorkGroupID.xy % block_size();
    uvec2 block = gl_WorkGroupID.xy / block_size() * gl_WorkGroupSize.xy * block_size();
    ivec2 pixel = ivec2(block + gl_LocalInvocationID.xy * block_size() + set);
    if (!in_picture(pixel)) return;
    Receiver r = receiver(pixel);
    uint bits = 0u;
    if (r.distance > 0.0) {
        // Lifted as in glsl/visibility/ray-traced.comp.
        float off = r.distance * length(view.it.up) / (128.0 * float(view.it.height));
        vec3 from = off_surface(r.position + r.normal * (off + 2e-6 * view.it.diagonal), r.normal);
        for (uint i = 0u; i < 32u; i++) {
            uint index = (gl_WorkGroupID.z * 32u + i) * SETS + number_of(set);
            if (index >= params.count) break;
            vec3 to_light = -octahedral_snorm16_inverse(places.at[index].normal);
            // Traced only if light would arrive.
            if (dot(r.normal, to_light) > 0.0) bits |= is_occluded(make_ray(from, to_light), 1e30) ? 0u : 1u << i;
        }
    }
    imageStore(visible, ivec3(pixel, gl_WorkGroupID.z), uvec4(bits));
}
