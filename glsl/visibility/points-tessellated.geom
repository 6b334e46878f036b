#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Points into the partitions given by their hashes.
#include "visibility/patch-point.glsl"

// A geometry stage must declare an output; this one emits nothing.
layout(points, max_vertices = 1) out;
out gl_PerVertex { float gl_PointSize; };

layout(scalar) writeonly buffer Points { Point at[]; } points;
layout(scalar) buffer Fill { uint at[]; } fill;

void main() {
    gl_PointSize = 1.0;
    Point point;
    uvec4 hash;
    if (!small_triangles_point(point, hash)) return;
    uint part = hashed_index(hash.x, params.partitions) - params.first;
    if (part >= params.held) return;
    uint slot = atomicAdd(fill.at[part], 1u);
    if (slot < params.capacity) points.at[part * params.capacity + slot] = point;
}
