#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Flux arriving at each texel with a surface. It is computed after rasterization, so that hidden surfaces cost nothing.
#include "lib/light.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint LIGHT_KIND = 4; // of all lights, or MIXED

layout(scalar, push_constant) uniform Params {
    uvec3 size; // width, height, layers
} params;

layout(scalar) uniform LightsBlock { Light at[MAX_LIGHTS]; } lights;
uniform sampler2DArray rsm_depth;
layout(rgba32f) writeonly uniform image2DArray flux;

void main() {
    if (any(greaterThanEqual(gl_GlobalInvocationID, params.size))) return;
    ivec3 texel = ivec3(gl_GlobalInvocationID);
    Light light = lights.at[texel.z];
    if (LIGHT_KIND != MIXED) light.kind = LIGHT_KIND;
    vec2 ndc = (vec2(texel.xy) + 0.5) / vec2(params.size.xy) * 2.0 - 1.0;
    bool surface = texelFetch(rsm_depth, texel, 0).r > 0.0;
    imageStore(flux, texel, surface ? vec4(texel_flux(light, ndc), 1.0) : vec4(0.0));
}
