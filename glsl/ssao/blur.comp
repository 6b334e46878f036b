#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Sum over the pattern's four texels of a row or a column, restricted to the same surface.
#include "lib/packing.glsl"
#include "lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const bool VERTICAL = false;

layout(scalar, push_constant) uniform Params {
    ivec2 size;
    float tolerance; // of the distance
} params;

layout(r32f) readonly uniform image2D distances;
layout(rg32f) readonly uniform image2D sharp;
layout(rg32f) writeonly uniform image2D blurred;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, params.size))) return;
    ivec2 along = ivec2(1, 0);
    if (VERTICAL) along = ivec2(0, 1);
    float z = imageLoad(distances, texel).r;
    // Slope of the distance, from the side that changes less, so that receding surfaces stay connected.
    float before = imageLoad(distances, clamp(texel - along, ivec2(0), params.size - 1)).r;
    float after = imageLoad(distances, clamp(texel + along, ivec2(0), params.size - 1)).r;
    float slope = abs(after - z) < abs(z - before) ? after - z : z - before;
    vec2 sum = vec2(0.0);
    // Five texels, the outer two with half weight: four in all, centred.
    for (int i = -2; i <= 2; i++) {
        ivec2 at = clamp(texel + i * along, ivec2(0), params.size - 1);
        float other = imageLoad(distances, at).r;
        bool same = other > 0.0 && abs(other - z - slope * float(i)) < params.tolerance * z;
        sum += same ? imageLoad(sharp, at).rg * (abs(i) == 2 ? 0.5 : 1.0) : vec2(0.0);
    }
    imageStore(blurred, texel, vec4(sum, 0.0, 0.0));
}
