#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// VPLs whose imperfect shadow maps others share: in each block of a reflective shadow map's texels, the lit VPL nearest to the block's
// middle.
#include "lib/permutation.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    uvec2 size;   // texels of a map
    uvec2 blocks; // of a map
    uint count;   // VPLs, one a texel
    uint proxies;
} params;

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Areas { float at[]; } areas;
layout(scalar) writeonly buffer ProxyPlaces { VplPlace at[]; } proxy_places;
layout(scalar) writeonly buffer ProxyAreas { float at[]; } proxy_areas;
layout(scalar) writeonly buffer Labels { uint at[]; } labels; // proxy of each VPL

void main() {
    uint proxy = gl_GlobalInvocationID.x;
    if (proxy >= params.proxies) return;
    uint in_map = params.blocks.x * params.blocks.y, layer = proxy / in_map, block = proxy % in_map;
    uvec2 at = uvec2(block % params.blocks.x, block / params.blocks.x);
    uvec2 low = at * params.size / params.blocks, high = (at + 1u) * params.size / params.blocks;
    vec2 middle = 0.5 * vec2(low + high - 1u);
    uint best = 0xffffffffu;
    float least = 0.0;
    for (uint y = low.y; y < high.y; y++) {
        for (uint x = low.x; x < high.x; x++) {
            uint index = permutation_inverse((layer * params.size.y + y) * params.size.x + x, params.count);
            labels.at[index] = proxy;
            vec2 off = vec2(x, y) - middle;
            float squared = dot(off, off);
            if (areas.at[index] > 0.0 && (best == 0xffffffffu || squared < least)) {
                least = squared;
                best = index;
            }
        }
    }
    VplPlace place = VplPlace(vec3(0.0), 0u);
    if (best != 0xffffffffu) place = places.at[best];
    proxy_places.at[proxy] = place;
    proxy_areas.at[proxy] = best != 0xffffffffu ? areas.at[best] : 0.0;
}
