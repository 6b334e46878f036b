#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Bounds of every 64 caches, which are made voxel by voxel and so lie close together: a workgroup a tile.
#include "gather/cache-tile.glsl"
#include "lib/light-cache.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params { uint count; } params;

layout(scalar) readonly buffer Caches { LightCache at[]; } caches;
layout(scalar) writeonly buffer Tiles { CacheTile at[]; } tiles;

shared CacheTile bounds[64];

void main() {
    uint tile = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, me = gl_LocalInvocationID.x;
    // The last tile may be smaller, and repeats its last cache.
    vec3 position = caches.at[min(tile * 64u + me, params.count - 1u)].position;
    bounds[me] = CacheTile(position, position);
    barrier();
    for (uint half_ = 32u; half_ > 0u; half_ >>= 1u) {
        if (me < half_) {
            CacheTile other = bounds[me + half_];
            bounds[me] = CacheTile(min(bounds[me].low, other.low), max(bounds[me].high, other.high));
        }
        barrier();
    }
    if (me == 0u && tile * 64u < params.count) tiles.at[tile] = bounds[0];
}
