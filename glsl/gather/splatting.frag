#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Light of a VPL at a pixel that its hull covers.
#include "gather/shadow-none.glsl"
#include "gather/stochastic.glsl"

layout(constant_id = 1) const bool GLOSSY = false;

layout(location = 0) flat in uint in_vpl;
layout(location = 0) out vec4 sum;

#include "gather/reflection-none.glsl"

void main() {
    uvec2 size = (uvec2(view.it.width, view.it.height) + block_size() - 1u) / block_size(), place = uvec2(gl_FragCoord.xy);
    Pixel p = pixel_at(ivec2(place % size * block_size() + place / size));
    sum = vec4(0.0);
    // The far face's depth test: a surface behind the hull is out of range. Steep faces may be a pixel off.
    float far_side = gl_FragCoord.z - fwidth(gl_FragCoord.z);
    if (p.at.distance <= 0.0 || far_side * p.at.distance > view.it.near) return;
    if (GLOSSY) shade(p, glossy_vpl(in_vpl), 1.0);
    else shade(p, diffuse_vpl(in_vpl), 1.0);
    sum.rgb = p.sum;
}
