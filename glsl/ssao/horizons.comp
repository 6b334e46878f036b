#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Ambient occlusion from horizons in the depth (Jimenez et al. 2016). In a slice of directions around the view direction, the horizons on
// both sides bound the visible arc of the hemisphere, whose cosine-weighted integral is known in closed form. An occluder's weight falls
// with its distance: 1 - d^2 / radius^2. Pixels of a 4 x 4 pattern take 16 different slices. Stored are the visible and the unoccluded
// integral: their sums over the pattern are divided.
#include "lib/packing.glsl"
#include "lib/pi.glsl"
#include "lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar, push_constant) uniform Params {
    ivec2 size;
    int step;
    float radius; // metres
    int samples;  // to each side
} params;

layout(scalar) uniform ViewBlock { View it; } view;
uniform sampler2D normal;
layout(r32f) readonly uniform image2D distances;
layout(rg32f) writeonly uniform image2D seen;

const float MOST_TEXELS = 96.0;

// Vector from the eye to a texel's surface.
vec3 place(ivec2 texel, float distance) {
    vec2 ndc = (vec2(texel * params.step) + 0.5) / vec2(view.it.width, view.it.height) * 2.0 - 1.0;
    return (view.it.forward + ndc.x * view.it.right - ndc.y * view.it.up) * distance;
}

// Cosine-weighted integral over a slice from the view direction to the horizon h, with the normal at gamma in the slice.
float arc(float h, float gamma) { return 0.25 * (cos(gamma) - cos(2.0 * h - gamma) + 2.0 * h * sin(gamma)); }

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, params.size))) return;
    float z = imageLoad(distances, texel).r;
    if (z == 0.0) {
        imageStore(seen, texel, vec4(0.0));
        return;
    }
    vec3 n = octahedral_inverse(texelFetch(normal, texel * params.step, 0).xy);
    vec3 x = place(texel, z);
    vec3 to_eye = -normalize(x);
    // Permuted within the pattern, so that neighbours differ much.
    int number = ((texel.x & 3) * 5 + (texel.y & 3) * 7) & 15;
    float phi = (float(number) + 0.5) * (PI / 16.0);
    float jitter = (float((number * 7 + 3) & 15) + 0.5) / 16.0;
    vec2 across = vec2(cos(phi), sin(phi));
    vec3 slice = across.x * normalize(view.it.right) - across.y * normalize(view.it.up);
    vec3 axis = normalize(cross(slice, to_eye));
    vec3 in_slice = n - axis * dot(n, axis);
    float share = length(in_slice);
    float gamma = acos(clamp(dot(in_slice, to_eye) / max(share, 1e-6), -1.0, 1.0));
    if (dot(slice - to_eye * dot(slice, to_eye), in_slice) < 0.0) gamma = -gamma;

    float texels = params.radius / z * 0.5 * float(view.it.height) / length(view.it.up) / float(params.step);
    texels = min(texels, MOST_TEXELS);
    float visible = 0.0, open = 0.0;
    for (int side = -1; side <= 1; side += 2) {
        float lowest = gamma + float(side) * 0.5 * PI; // horizon of the hemisphere
        float whole = arc(lowest, gamma);
        float highest = 0.0; // sine of elevation over the surface, in the slice
        float above = whole;
        for (int i = 0; i < params.samples; i++) {
            // Samples are denser near the pixel.
            float t = (float(i) + jitter) / float(params.samples);
            vec2 way = across * float(side) * max(t * t * texels, float(i) + 1.0);
            ivec2 at = texel + ivec2(round(way));
            if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, params.size))) continue;
            float other = imageLoad(distances, at).r;
            vec3 d = place(at, other) - x;
            float squared = dot(d, d);
            // The weight falls in front and behind alike: a distant surface may be no occluder but an object in the foreground.
            float weight = other > 0.0 ? clamp(1.0 - squared / (params.radius * params.radius), 0.0, 1.0) : 0.0;
            // Elevation over the surface itself, so that a plane does not occlude itself wherever texels lie; less a margin for rounding.
            float rises = dot(d, n) * inversesqrt(max(squared, 1e-12)) / max(share, 1e-3) - 0.01;
            if (rises > highest && weight > 0.0) {
                highest = min(rises, 1.0);
                float rest = arc(lowest - float(side) * asin(highest), gamma);
                // Directions hidden by this sample, and by no nearer one.
                visible -= weight * (above - rest);
                above = rest;
            }
        }
        visible += whole;
        open += whole;
    }
    imageStore(seen, texel, vec4(share * visible, share * open, 0.0, 0.0));
}
