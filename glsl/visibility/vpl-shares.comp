#version 460
#extension GL_EXT_scalar_block_layout : require
// Shares the points out among the VPLs by how much they see, and says where each VPL's points begin. One workgroup.
layout(local_size_x = 256) in;

layout(scalar, push_constant) uniform Params {
    uint count;  // VPLs
    uint points; // of all
} params;

layout(scalar) readonly buffer Views { float at[]; } views;
layout(scalar) writeonly buffer Begins { uint at[]; } begins; // one more, for the end

shared float sums[256];
shared uint counts[256];

// What lies behind something else is seen by the sum, but not by the map: beyond a hemisphere twice over, more says nothing.
float share(float view) { return min(view, 12.566371); }

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint each = (params.count + 255u) / 256u;
    uint low = min(lane * each, params.count), high = min(low + each, params.count);
    float sum = 0.0;
    for (uint i = low; i < high; i++) sum += share(views.at[i]);
    sums[lane] = sum;
    barrier();
    float total = 0.0;
    for (uint i = 0u; i < 256u; i++) total += sums[i];
    // A millionth less than all, so that rounding takes none too many.
    float scale = total > 0.0 ? float(params.points) * 0.999999 / total : 0.0;
    uint own = 0u;
    for (uint i = low; i < high; i++) own += uint(share(views.at[i]) * scale);
    counts[lane] = own;
    barrier();
    uint begin = 0u;
    for (uint i = 0u; i < lane; i++) begin += counts[i];
    for (uint i = low; i < high; i++) {
        begins.at[i] = begin;
        begin += uint(share(views.at[i]) * scale);
    }
    if (lane == 255u) begins.at[params.count] = begin;
}
