#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Direct light at a pixel. Each part for "shadow" defines
//     float visibility(Light light, uint layer, vec3 x, vec3 n);
// the share of a light, or of one face of a point light, that arrives at a point of a surface.
#include "gbuffer/receiver.glsl"
#include "lib/brdf.glsl"
#include "lib/color.glsl"
#include "lib/light.glsl"

layout(local_size_x = 32, local_size_y = 2) in;
layout(constant_id = 0) const bool GLOSSY_DIELECTRIC = false;
layout(constant_id = 1) const uint LIGHT_KIND = 4; // of all lights, or MIXED
layout(constant_id = 2) const bool METALS = true;  // whether the scene has metals

layout(scalar, push_constant) uniform Params {
    uint lights;
    float bias;      // metres
    ivec2 map_size;  // texels
    int radius;      // texels
    float lift;      // texels
} params;

layout(scalar) uniform LightsBlock { Light at[MAX_LIGHTS]; } lights;
uniform sampler2D albedo;
uniform sampler2D metallic_roughness;
layout(rgba16f) writeonly uniform image2D direct;

#include "part/shadow=direct/shadow-none"
#include "part/sky=direct/sky-none"

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (!in_picture(pixel)) return;
    Receiver r = receiver(pixel);
    vec3 sum = vec3(0.0);
    if (r.distance > 0.0) {
        vec3 base = texelFetch(albedo, pixel, 0).rgb;
        vec2 mr = texelFetch(metallic_roughness, pixel, 0).rg;
        vec3 v = normalize(view.it.position - r.position);
        sum += reflected_sky(pixel, base, METALS ? mr.x : 0.0);
        for (uint i = 0u; i < params.lights; i++) {
            Light light = lights.at[i];
            if (LIGHT_KIND != MIXED) light.kind = LIGHT_KIND;
            vec3 l;
            vec3 arriving = light_irradiance(light, r.position, l) * max(dot(r.normal, l), 0.0);
            if (any(greaterThan(arriving, vec3(0.0)))) {
                arriving *= visibility(light, i, r.position, r.normal);
                sum += arriving * brdf(base, METALS ? mr.x : 0.0, mr.y, GLOSSY_DIELECTRIC, r.normal, l, v);
            }
        }
    }
    imageStore(direct, pixel, vec4(min(sum, LARGEST_HALF), 1.0));
}
