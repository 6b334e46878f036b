#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Mean and mean square of the distance along a row of shadow-map texels (Donnelly and Lauritzen 2006).
#include "lib/light.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params {
    ivec3 size; // width, height, layers
    int radius; // texels
} params;

layout(scalar) uniform LightsBlock { Light at[MAX_LIGHTS]; } lights;
uniform sampler2DArray shadow_depth;
layout(rg32f) writeonly uniform image2DArray moments;

void main() {
    ivec3 texel = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(texel, params.size))) return;
    Light light = lights.at[texel.z];
    vec2 sum = vec2(0.0);
    for (int offset = -params.radius; offset <= params.radius; offset++) {
        int x = clamp(texel.x + offset, 0, params.size.x - 1);
        // An empty texel gets a distance beyond all surfaces.
        float depth = max(texelFetch(shadow_depth, ivec3(x, texel.yz), 0).r, light.kind == DIRECTIONAL ? 0.0 : 1e-4);
        float distance = light_distance(light, depth);
        sum += vec2(distance, distance * distance);
    }
    imageStore(moments, texel, vec4(sum / float(2 * params.radius + 1), 0.0, 0.0));
}
