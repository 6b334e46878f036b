#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Mask of the depth slices of each tile that hold pixels, a workgroup a tile.
#include "gather/froxel.glsl"

layout(local_size_x = 16, local_size_y = 16) in;

layout(scalar) uniform ViewBlock { View it; } view;
uniform sampler2D depth;
layout(scalar) writeonly buffer Slices { uint at[]; } slices;

shared uint used;

void main() {
    if (gl_LocalInvocationIndex == 0u) used = 0u;
    barrier();
    uint mine = 0u;
    ivec2 corner = ivec2(gl_WorkGroupID.xy) * FROXEL_TILE;
    for (int y = int(gl_LocalInvocationID.y); y < FROXEL_TILE; y += 16) {
        for (int x = int(gl_LocalInvocationID.x); x < FROXEL_TILE; x += 16) {
            ivec2 pixel = corner + ivec2(x, y);
            bool inside = all(lessThan(uvec2(pixel), uvec2(view.it.width, view.it.height)));
            float z = inside ? texelFetch(depth, pixel, 0).r : 0.0;
            mine |= z > 0.0 ? 1u << slice_of(view.it, view.it.near / z) : 0u;
        }
    }
    atomicOr(used, mine);
    barrier();
    if (gl_LocalInvocationIndex == 0u) slices.at[gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x] = used;
}
