#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Shadow rays between pixels and virtual point lights: an invocation traces those of one pixel and 32 VPLs. Pixels share the VPLs as in
// glsl/gather/per-pixel.glsl.
#include "bvh/hole.glsl"
#include "gbuffer/receiver.glsl"
#include "lib/interleave.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(scalar, push_constant) uniform Params {
    uint count; // VPLs
} params;

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Areas { float at[]; } areas; // 0 of VPLs that are dark
layout(r32ui) writeonly uniform uimage2DArray visible;

// Position lifted off a surface that was reconstructed from depth. Rasterizers snap corners by up to a 256th of a pixel, which moves the
// surface by up to `off`, metres.
vec3 lifted(vec3 position, vec3 n, float off) { return off_surface(position + n * (off + 2e-6 * view.it.diagonal), n); }

void main() {
    uvec2 set = gl_WorkGroupID.xy % block_size();
    uvec2 block = gl_WorkGroupID.xy / block_size() * gl_WorkGroupSize.xy * block_size();
    ivec2 pixel = ivec2(block + gl_LocalInvocationID.xy * block_size() + set);
    if (!in_picture(pixel)) return;
    Receiver r = receiver(pixel);
    uint bits = 0u;
    if (r.distance > 0.0) {
        vec3 from = lifted(r.position, r.normal, r.distance * length(view.it.up) / (128.0 * float(view.it.height)));
        for (uint i = 0u; i < 32u; i++) {
            uint index = (gl_WorkGroupID.z * 32u + i) * SETS + number_of(set);
            if (index >= params.count) break;
            VplPlace vpl = places.at[index];
            vec3 facing = octahedral_snorm16_inverse(vpl.normal);
            vec3 way = vpl.position - r.position;
            // Traced only if light would arrive.
            if (dot(r.normal, way) > 0.0 && dot(facing, way) < 0.0 && areas.at[index] > 0.0) {
                bits |= is_occluded(make_ray(from, lifted(vpl.position, facing, 2e-5 * view.it.diagonal) - from), 1.0) ? 0u : 1u << i;
            }
        }
    }
    imageStore(visible, ivec3(pixel, gl_WorkGroupID.z), uvec4(bits));
}
