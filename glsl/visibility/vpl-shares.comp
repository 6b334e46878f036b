#version 460
#extension GL_EXT_scalar_block_layout : require
// Shares the points among the VPLs in proportion to the solid angle that they see, and writes the start of each VPL's points. One
// workgroup.
layout(local_size_x = 256) in;

layout(scalar, push_constant) uniform Params {
    uint count;  // VPLs
    uint points; // points of all VPLs
} params;

layout(scalar) readonly buffer Views { float at[]; } views;
layout(scalar) writeonly buffer Begins { uint at[]; } begins; // one more element, for the end

shared float sums[256];
shared uint counts[256];

// The sum ignores occlusion, unlike the map: beyond twice a hemisphere, it carries no information.
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
    // Reduced by a millionth, so that rounding does not exceed the total.
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
