#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Texel with inputs of diffuse VPLs and of glossy lobes (Tokuyoshi and Harada 2017).
#include "rsm/surface.glsl"

layout(constant_id = 7) const bool GLOSSY_DIELECTRIC = false;
layout(location = 3) in vec3 in_normal;

layout(location = 2) out vec4 specular; // Fresnel reflectance at normal and grazing incidence, times the glossy share
layout(location = 3) out vec4 lobe;     // interpolated normal, octahedral, and GGX's alpha

void main() {
    Surface it = surface();
    put_diffuse(it);
    float glossy = it.metallic;
    vec3 f0 = it.metallic * it.tint;
    if (GLOSSY_DIELECTRIC) {
        f0 += (1.0 - it.metallic) * 0.04;
        glossy = 1.0;
    }
    specular = it.lit ? vec4(f0, glossy) : vec4(0.0);
    // Flipped with the geometric normal, which faces the light.
    lobe = vec4(octahedral(normalize(gl_FrontFacing ? in_normal : -in_normal)), max(it.roughness * it.roughness, 1e-3), 0.0);
    cut_out(it);
}
