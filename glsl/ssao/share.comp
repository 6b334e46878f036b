#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Share of the hemisphere that a pixel sees, interpolated from texels on its surface.
#include "lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params {
    ivec2 size; // of the texels
    int step;   // pixels a texel
    float strength;
} params;

layout(scalar) uniform ViewBlock { View it; } view;
uniform sampler2D depth;
layout(r32f) readonly uniform image2D distances;
layout(rg32f) readonly uniform image2D seen;
layout(r32f) writeonly uniform image2D visible;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), uvec2(view.it.width, view.it.height)))) return;
    float depth_here = texelFetch(depth, pixel, 0).r;
    float share = 1.0;
    if (depth_here > 0.0) {
        float z = view.it.near / depth_here;
        vec2 sum = vec2(0.0);
        ivec2 corner = pixel / params.step;
        vec2 within = vec2(pixel - corner * params.step) / float(params.step);
        int last = params.step > 1 ? 3 : 0;
        for (int i = 0; i <= last; i++) {
            ivec2 offset = ivec2(i & 1, i >> 1);
            ivec2 at = min(corner + offset, params.size - 1);
            vec2 bilinear = mix(1.0 - within, within, vec2(offset));
            float other = imageLoad(distances, at).r;
            float off = abs(other - z) / z;
            float weight = other > 0.0 ? (bilinear.x * bilinear.y + 1e-3) / (1e-4 + off * off) : 0.0;
            sum += weight * imageLoad(seen, at).rg;
        }
        share = sum.y > 0.0 ? clamp(sum.x / sum.y, 0.0, 1.0) : 1.0;
    }
    imageStore(visible, pixel, vec4(mix(1.0, share, params.strength)));
}
