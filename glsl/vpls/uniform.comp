#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Uniform sampling of all maps' texels (Barak et al. 2013): points over light, column and row.
#include "vpls/texel.glsl"
#include "part/points=vpls/points-halton"
#include "vpls/place.glsl"

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    put(index, place_of(point(index, 0u)), float(params.lights) * float(params.size.x) * float(params.size.y) / float(params.count));
}
