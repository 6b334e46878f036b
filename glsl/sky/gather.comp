#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Light of the sky: a pixel sums the directions of its sample set. Pixels share the directions as in glsl/gather/per-pixel.glsl. A part for
// "seen" defines
//     struct Direction; // what the test needs of a direction
//     Direction direction_at(uint index);
//     float sky_seen(Direction d, uint within, Receiver r, vec3 facing, float cosine);
// the share of the light of a direction, the set's direction number `within`, that arrives at a receiver; `facing` is the direction in
// which the light travels. A part for "reflection" defines
//     struct Reflection; // a receiver's glossy reflection so far
//     Reflection reflection_at(Receiver r);
//     float reflect_to_eye(inout Reflection g, Receiver r, vec3 to_light, vec3 irradiance);
//     void store(Receiver r, Reflection g);
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

struct Pixel {
    Receiver at;
    vec3 sum; // irradiance of the directions so far, W/m^2
    Reflection glossy;
};

Pixel pixel_at(ivec2 place) {
    Receiver r = receiver(place);
    return Pixel(r, vec3(0.0), reflection_at(r));
}

void store(Pixel p) {
    if (!in_picture(p.at.pixel)) return;
    imageStore(irradiance, p.at.pixel, vec4(min(p.sum * float(SETS), LARGEST_HALF), 1.0));
    store(p.at, p.glossy);
}

#include "gather/quad.glsl"

// The normal of a pixel without a surface is 0.
void shade(inout Pixel p, Direction d, uint within, vec3 facing, vec3 light) {
    float cosine = -dot(facing, p.at.normal);
    if (cosine > 0.0) {
        vec3 arriving = light * (cosine * sky_seen(d, within, p.at, facing, cosine));
        p.sum += arriving * reflect_to_eye(p.glossy, p.at, -facing, arriving);
    }
}

void main() {
    uvec2 set = gl_WorkGroupID.xy % block_size();
    uvec2 block = gl_WorkGroupID.xy / block_size() * gl_WorkGroupSize.xy * 2u * block_size();
    Quad q = quad_at(ivec2(block + gl_LocalInvocationID.xy * 2u * block_size() + set));
    uint within = 0u;
    for (uint i = number_of(set); i < params.count; i += SETS) {
        vec3 facing = octahedral_snorm16_inverse(places.at[i].normal), light = irradiances.at[i];
        Direction d = direction_at(i);
        shade(q.a, d, within, facing, light);
        shade(q.b, d, within, facing, light);
        shade(q.c, d, within, facing, light);
        shade(q.d, d, within, facing, light);
        within++;
    }
    store(q);
}
