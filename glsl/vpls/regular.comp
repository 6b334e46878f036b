#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Regular samples of the reflective shadow maps, in the order of a fixed permutation (Linke 2016, sections 4.3 and 4.5).
#include "lib/light.glsl"
#include "lib/packing.glsl"
#include "lib/permutation.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    uvec2 size;   // texels of a map
    uint lights;  // maps
    uint count;   // VPLs
} params;

layout(scalar) uniform LightsBlock { Light at[MAX_LIGHTS]; } lights;
uniform sampler2DArray rsm_depth;
uniform sampler2DArray rsm_normal;
uniform sampler2DArray rsm_flux;
uniform sampler2DArray rsm_albedo;
layout(scalar) writeonly buffer Points { VplPoint at[]; } points;
layout(scalar) writeonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) buffer Lit { uint count; } lit;

const float PI = 3.14159265358979;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    uint sample_index = permutation(index, params.count);

    // The first lights get what the division leaves over.
    uint share = params.count / params.lights, rest = params.count % params.lights;
    uint larger = (share + 1u) * rest;
    uint layer = sample_index < larger ? sample_index / (share + 1u) : rest + (sample_index - larger) / share;
    uint count = share + uint(layer < rest);
    uint k = sample_index - (layer * share + min(layer, rest));

    // Rows of samples whose spacing is as near to a square's as whole numbers let it be. Rows differ by one sample at most, and
    // each sample stands for its own share of the map's texels.
    uint rows = clamp(uint(round(sqrt(float(count) * float(params.size.y) / float(params.size.x)))), 1u, min(count, params.size.y));
    uint in_row = count / rows, longer = count % rows;
    uint in_longer = (in_row + 1u) * longer;
    uint row = k < in_longer ? k / (in_row + 1u) : longer + (k - in_longer) / in_row;
    uint columns = in_row + uint(row < longer);
    uint column = k - (row * in_row + min(row, longer));
    // The texel that holds the middle of the sample's share: in whole numbers, so that every device takes the same.
    ivec2 texel = ivec2((2u * uvec2(column, row) + 1u) * params.size / (2u * uvec2(columns, rows)));
    float texels = float(params.size.x) / float(columns) * (float(params.size.y) / float(rows));

    VplPoint point = VplPoint(vec3(0.0), 0u);
    vec3 intensity = vec3(0.0);
    ivec3 at = ivec3(texel, layer);
    float depth = texelFetch(rsm_depth, at, 0).r;
    if (depth > 0.0) {
        vec2 ndc = (vec2(texel) + 0.5) / vec2(params.size) * 2.0 - 1.0;
        point.position = light_position(lights.at[layer], ndc, depth);
        point.normal = octahedral_snorm16(octahedral_inverse(texelFetch(rsm_normal, at, 0).xy));
        intensity = texelFetch(rsm_flux, at, 0).rgb * texelFetch(rsm_albedo, at, 0).rgb * (texels / PI);
    }
    points.at[index] = point;
    intensities.at[index] = intensity;
    if (any(greaterThan(intensity, vec3(0.0)))) atomicAdd(lit.count, 1u);
}
