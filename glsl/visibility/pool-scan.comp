#version 460
#extension GL_EXT_scalar_block_layout : require
// Start of each chunk's points: an exclusive prefix sum of the counts. One workgroup.
layout(local_size_x = 256) in;

layout(scalar, push_constant) uniform Params {
    uint groups;
} params;

layout(scalar) readonly buffer Counts { uint at[]; } counts;
layout(scalar) writeonly buffer Begins { uint at[]; } begins; // one more element, for the end

shared uint sums[256];

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint each = (params.groups + 255u) / 256u;
    uint low = min(lane * each, params.groups), high = min(low + each, params.groups);
    uint sum = 0u;
    for (uint i = low; i < high; i++) sum += counts.at[i];
    sums[lane] = sum;
    barrier();
    uint begin = 0u;
    for (uint i = 0u; i < lane; i++) begin += sums[i];
    for (uint i = low; i < high; i++) {
        begins.at[i] = begin;
        begin += counts.at[i];
    }
    if (lane == 255u) begins.at[params.groups] = begin;
}
