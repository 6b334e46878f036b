#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// No indirect light.
layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params { ivec2 size; } params;

layout(rgba16f) writeonly uniform image2D irradiance;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (all(lessThan(pixel, params.size))) imageStore(irradiance, pixel, vec4(0.0, 0.0, 0.0, 1.0));
}
