#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Gather by the linked light lists of froxels.
#include "gather/shadow-none.glsl"
#include "gather/stochastic.glsl"
#include "gather/shell-froxel.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar) readonly buffer Heads { uvec2 at[]; } heads;
layout(scalar) readonly buffer Nodes { uvec2 at[]; } nodes;
#include "part/numbers=gather/numbers-none"
layout(rgba16f) writeonly uniform image2D irradiance;

const uint END = 0xffffffffu;

#include "gather/reflection-none.glsl"

void main() {
    // Neighbouring workgroups process the sample sets of the same block of pixels.
    uvec2 set = gl_WorkGroupID.xy % block_size(), place = gl_WorkGroupID.xy / block_size() * 8u + gl_LocalInvocationID.xy;
    ivec2 pixel = ivec2(place * block_size() + set);
    if (any(greaterThanEqual(uvec2(pixel), uvec2(view.it.width, view.it.height)))) return;
    Pixel p = pixel_at(pixel);
    if (p.at.distance > 0.0) {
        uvec2 tiles = ((uvec2(view.it.width, view.it.height) + block_size() - 1u) / block_size() + SHELL_TILE - 1u) / SHELL_TILE;
        uint tile = place.y / SHELL_TILE * tiles.x + place.x / SHELL_TILE, number = number_of(set);
        uvec2 head = heads.at[(number * tiles.x * tiles.y + tile) * SHELL_SLICES + shell_slice(p.at.distance, view.it.diagonal)];
        for (uint node = head.x; node != END; node = nodes.at[node].y) {
            p.numbers.x++;
            shade(p, diffuse_vpl(nodes.at[node].x), 1.0);
        }
        for (uint node = head.y; node != END; node = nodes.at[node].y) {
            p.numbers.z++;
            shade(p, glossy_vpl(nodes.at[node].x), 1.0);
        }
    }
    imageStore(irradiance, pixel, vec4(min(p.sum * float(SETS), LARGEST_HALF), 1.0));
    store_numbers(pixel, vec4(p.numbers));
}
