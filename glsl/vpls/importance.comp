#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Importance of a map's cell: the reflected flux times the share of the hemisphere in which the map, taken as a height field, has surfaces.
// A roof below the sky has little, a courtyard between walls most of its flux.
#include "lib/color.glsl"
#include "lib/light.glsl"
#include "lib/packing.glsl"
#include "vpls/distribution.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params { ivec2 size; } params; // texels of a map

layout(scalar) uniform LightsBlock { Light at[MAX_LIGHTS]; } lights;
uniform sampler2DArray rsm_depth;
uniform sampler2DArray rsm_normal;
uniform sampler2DArray rsm_flux;
uniform sampler2DArray rsm_albedo;
layout(scalar) writeonly buffer Importances { float at[]; } importances; // of cells, row by row, layer by layer
#include "vpls/enclosure.glsl"

const uint TEXELS = 4u; // samples of a cell, two by two
const uint RAYS = 4u;   // rays from each sample
// A floor: a surface without apparent receivers may have some, so every lit surface keeps a chance of VPLs.
const float LEAST = 0.03;

void main() {
    uvec3 cell = gl_GlobalInvocationID;
    Light light = lights.at[cell.z];
    float passed = 0.0;
    for (uint i = 0u; i < TEXELS; i++) {
        vec2 within = (vec2(i & 1u, i >> 1u) + 0.5) * 0.5;
        ivec3 texel = ivec3(min(ivec2((vec2(cell.xy) + within) * vec2(params.size) / float(CELLS)), params.size - 1), cell.z);
        float depth = texelFetch(rsm_depth, texel, 0).r;
        vec2 ndc = (vec2(texel.xy) + 0.5) / vec2(params.size) * 2.0 - 1.0;
        if (depth == 0.0) {
            // Surfaces too small for the samples may be in the cell.
            passed += 1e-5 * luminance(texel_flux(light, ndc));
            continue;
        }
        vec3 position = light_position(light, ndc, depth), normal = octahedral_inverse(texelFetch(rsm_normal, texel, 0).xy);
        float texel_width = sqrt(texel_beam(light, ndc, position));
        float kept = enclosure(light, cell.z, params.size, position, normal, texel_width, i * RAYS, RAYS, TEXELS * RAYS);
        float reflected = luminance(texelFetch(rsm_flux, texel, 0).rgb) * (luminance(texelFetch(rsm_albedo, texel, 0).rgb) + LEAST);
        passed += reflected * (kept + LEAST);
    }
    importances.at[(cell.z * CELLS + cell.y) * CELLS + cell.x] = passed;
}
