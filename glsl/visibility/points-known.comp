#version 460
#extension GL_EXT_scalar_block_layout : require
// Writes a number that the host knows into a counter.
layout(local_size_x = 1) in;

layout(scalar, push_constant) uniform Params {
    uint number;
} params;

layout(scalar) writeonly buffer Known { uint count; } known;

void main() { known.count = params.number; }
