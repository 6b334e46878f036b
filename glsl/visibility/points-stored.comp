#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Stored points, in their order: an invocation a point.
#include "visibility/stored.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    float diagonal; // of the scene's bounds, metres
    uint count;
} params;

struct StoredPoint {
    uint triangle;
    uint weights;
};

layout(scalar) readonly buffer Records { StoredPoint at[]; } records;
layout(scalar) writeonly buffer Points { Point at[]; } points;

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (i < params.count) points.at[i] = stored_point(uvec2(records.at[i].triangle, records.at[i].weights), params.diagonal);
}
