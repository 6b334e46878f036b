#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Surfaces at Halton pixels of the picture, for which VPLs are chosen (Barak et al. 2013, section 4.1). A pixel without a surface counts
// as black and is not replaced, so that importances of two frames are sums over as many samples.
#include "gbuffer/receiver.glsl"
#include "lib/color.glsl"
#include "lib/halton.glsl"
#include "vpls/view-sample.glsl"

layout(local_size_x = 64) in;

// Whether light counts where it arrives: samples are white then, and not as they reflect.
layout(constant_id = 0) const bool WHITE = false;
layout(constant_id = 1) const bool GLOSSY_RECEIVERS = false; // GGX at the view samples

layout(scalar, push_constant) uniform Params {
    vec2 shift; // rotation of the point set modulo 1
    uint count;
} params;

uniform sampler2D albedo;
uniform sampler2D metallic_roughness;
layout(scalar) writeonly buffer ViewSamples { ViewSample at[]; } view_samples;
layout(scalar) writeonly buffer ViewSampleLobes { ViewSampleLobe at[]; } view_lobes;

void main() {
    uint index = gl_GlobalInvocationID.x;
    // Samples are read by twos.
    if (index >= (params.count + 1u) / 2u * 2u) return;
    vec2 u = fract(vec2(radical_inverse(index + 1u, 2u), radical_inverse(index + 1u, 3u)) + params.shift);
    ivec2 size = ivec2(view.it.width, view.it.height), pixel = min(ivec2(u * vec2(size)), size - 1);
    Receiver at = receiver(pixel);
    ViewSample it = ViewSample(at.position, -1.0, at.normal);
    ViewSampleLobe lobe = NO_LOBE;
    if (at.distance > 0.0 && index < params.count) {
        vec2 surface = texelFetch(metallic_roughness, pixel, 0).xy;
        // A metal's diffuse albedo is 0.
        float diffuse = GLOSSY_RECEIVERS ? 1.0 : 1.0 - surface.x;
        it.albedo = WHITE ? 1.0 : diffuse * luminance(texelFetch(albedo, pixel, 0).rgb);
        lobe = ViewSampleLobe(normalize(view.it.position - at.position), surface.y, surface.x);
    }
    view_samples.at[index] = it;
    view_lobes.at[index] = lobe;
}
