#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Largest area of a small triangle that gives the asked number of points, from the areas of the triangles as they are now: what
// src/stages/visibility/areas.rs does for a scene whose areas stay. One workgroup.
#include "visibility/area-bin.glsl"
#include "visibility/point.glsl"

layout(local_size_x = 256) in;

layout(constant_id = 0) const bool THIN = false;

layout(scalar, push_constant) uniform Params {
    uint points; // asked for
    uint chunks;
} params;

struct ChunkArea {
    float sum;
    float largest;
};

struct PointSizes {
    float max_area;
};

layout(scalar) readonly buffer Bins { AreaBin at[]; } bins;
layout(scalar) readonly buffer ChunkAreas { ChunkArea at[]; } chunk_areas;
layout(scalar) writeonly buffer Found { PointSizes at[]; } found;

shared float sums[256];

// Sum over all invocations, in a fixed order.
float total(float own) {
    uint lane = gl_LocalInvocationID.x;
    sums[lane] = own;
    barrier();
    for (uint step = 128u; step > 0u; step /= 2u) {
        if (lane < step) sums[lane] += sums[lane + step];
        barrier();
    }
    float sum = sums[0];
    barrier();
    return sum;
}

// Points of this invocation's bins: an upper bound, with room for rounding.
float points_of_bins(float max_area) {
    float sum = 0.0;
    for (uint i = gl_LocalInvocationID.x; i < AREA_BINS; i += 256u) {
        AreaBin bin = bins.at[i];
        if (bin.count > 0u) {
            Subdivision parts = subdivision(uintBitsToFloat(bin.largest) * 1.00001, max_area);
            sum += float(bin.count) * float(parts.split * parts.split) * float(points_of_level(parts.level));
        }
    }
    return sum;
}

void main() {
    uint lane = gl_LocalInvocationID.x;
    float own = 0.0;
    for (uint i = lane; i < params.chunks; i += 256u) own += chunk_areas.at[i].sum;
    float area = max(total(own), 1e-30);
    if (THIN) {
        if (lane == 0u) found.at[0].max_area = area / float(params.points);
        return;
    }
    // The number of points falls as the area of one rises. Bits of positive floats are in their order.
    uint low = floatBitsToUint(1e-37), high = floatBitsToUint(2.0 * area);
    for (uint i = 0u; i < 31u; i++) {
        uint middle = low + (high - low) / 2u;
        if (total(points_of_bins(uintBitsToFloat(middle))) > float(params.points)) low = middle; else high = middle;
    }
    if (lane == 0u) found.at[0].max_area = uintBitsToFloat(high);
}
