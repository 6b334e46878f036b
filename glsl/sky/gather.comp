#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Light of the sky: a pixel sums the directions of its sample set. Pixels share the directions as in glsl/gather/per-pixel.glsl. A part for
// "seen" defines
//     float sky_seen(uint index, uint within, Receiver r, vec3 facing, float cosine);
// the share of the light of direction `index`, the set's direction number `within`, that arrives at a receiver; `facing` is the direction in
// which the light travels. A part for "reflection" defines
//     void begin_reflection(Receiver r);
//     float reflect_to_eye(Receiver r, vec3 to_light, vec3 irradiance);
//     void end_reflection(Receiver r);
// of which the second adds irradiance on the receiver to its glossy reflection, and returns the share that remains for diffuse reflection.
#include "gbuffer/receiver.glsl"
#include "lib/color.glsl"
#include "lib/interleave.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 8, local_size_y = 4) in;

layout(scalar, push_constant) uniform Params {
    uint count;        // directions
    float least_alpha; // of glossy receivers
} params;

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Irradiances { vec3 at[]; } irradiances; // on a plane that faces the direction
layout(rgba16f) writeonly uniform image2D irradiance;

#include "part/seen=sky/seen-all"
#include "part/reflection=sky/reflection-none"

void main() {
    uvec2 set = gl_WorkGroupID.xy % block_size();
    uvec2 block = gl_WorkGroupID.xy / block_size() * gl_WorkGroupSize.xy * block_size();
    ivec2 pixel = ivec2(block + gl_LocalInvocationID.xy * block_size() + set);
    if (!in_picture(pixel)) return;
    Receiver r = receiver(pixel);
    vec3 sum = vec3(0.0);
    begin_reflection(r);
    if (r.distance > 0.0) {
        uint within = 0u;
        for (uint i = number_of(set); i < params.count; i += SETS) {
            vec3 facing = octahedral_snorm16_inverse(places.at[i].normal);
            float cosine = -dot(facing, r.normal);
            if (cosine > 0.0) {
                vec3 arriving = irradiances.at[i] * (cosine * sky_seen(i, within, r, facing, cosine));
                sum += arriving * reflect_to_eye(r, -facing, arriving);
            }
            within++;
        }
    }
    imageStore(irradiance, pixel, vec4(min(sum * float(SETS), LARGEST_HALF), 1.0));
    end_reflection(r);
}
