#version 460
#extension GL_EXT_scalar_block_layout : require
// Adds numbers to a counter. One workgroup.
layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    uint count;
} params;

layout(scalar) readonly buffer Numbers { uint at[]; } numbers;
layout(scalar) buffer Total { uint count; } total;

void main() {
    uint sum = 0u;
    for (uint i = gl_LocalInvocationID.x; i < params.count; i += 64u) sum += numbers.at[i];
    atomicAdd(total.count, sum);
}
