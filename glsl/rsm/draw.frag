#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "rsm/surface.glsl"

void main() {
    Surface it = surface();
    put_diffuse(it);
    cut_out(it);
}
