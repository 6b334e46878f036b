#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Hammersley samples of the reflective shadow maps, warped by the cells' importance: inversion of the distribution, rows first.
#include "vpls/distribution.glsl"
#include "vpls/texel.glsl"
#include "vpls/enclosure.glsl"

layout(scalar) readonly buffer Columns { float at[]; } columns;
layout(scalar) readonly buffer Rows { float at[]; } rows;
layout(scalar) writeonly buffer Kept { float at[]; } kept; // estimated share of each VPL's light that stays in the scene

const uint RAYS = 128u;

// Share of a texel's light that stays in the scene.
float stays(ivec3 at) {
    float depth = texelFetch(rsm_depth, at, 0).r;
    if (depth == 0.0) return 0.0;
    Light light = lights.at[at.z];
    vec2 ndc = (vec2(at.xy) + 0.5) / vec2(params.size) * 2.0 - 1.0;
    vec3 position = light_position(light, ndc, depth), normal = octahedral_inverse(texelFetch(rsm_normal, at, 0).xy);
    float texel_width = sqrt(texel_beam(light, ndc, position));
    return enclosure(light, uint(at.z), ivec2(params.size), position, normal, texel_width, 0u, RAYS, RAYS);
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    vec2 u = fract(hammersley(permutation(index, params.count), params.count) + params.shift.xy);

    uint low = 0u, high = params.lights * CELLS - 1u;
    float total = rows.at[high], wanted = u.x * total;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (rows.at[middle] > wanted) high = middle;
        else low = middle + 1u;
    }
    uint row = low;
    float before = row > 0u ? rows.at[row - 1u] : 0.0, weight = rows.at[row] - before;
    float down = weight > 0.0 ? clamp((wanted - before) / weight, 0.0, 0.999999) : 0.5;

    low = row * CELLS;
    high = low + CELLS - 1u;
    float in_row = columns.at[high];
    wanted = u.y * in_row;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (columns.at[middle] > wanted) high = middle;
        else low = middle + 1u;
    }
    before = low > row * CELLS ? columns.at[low - 1u] : 0.0;
    float chance = columns.at[low] - before;
    float across = chance > 0.0 ? clamp((wanted - before) / chance, 0.0, 0.999999) : 0.5;

    vec2 at = (vec2(low % CELLS, row % CELLS) + vec2(across, down)) / float(CELLS);
    ivec2 texel = min(ivec2(at * vec2(params.size)), ivec2(params.size) - 1);
    float texels = float(params.size.x) * float(params.size.y) / float(CELLS * CELLS);
    ivec3 place = ivec3(texel, row / CELLS);
    bool any = weight > 0.0 && chance > 0.0;
    put(index, place, any ? texels * (total / weight) * (in_row / chance) / float(params.count) : 0.0);
    // Never 0, which would leave the VPL's cluster without flux, whatever its map sees.
    kept.at[index] = max(stays(place), 0.001);
}
