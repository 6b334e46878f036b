#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Points as single pixels (Linke 2016, section 4.4.3): a workgroup a partition. Each point is considered for the maps of the
// partition's VPL and those that follow it, and drawn into the first few that can see it; the nearest point of a texel stays.
#include "lib/paraboloid.glsl"
#include "lib/vpl.glsl"
#include "visibility/ism.glsl"
#include "visibility/point.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint MAP_SIZE = 64;
layout(constant_id = 1) const bool DISTORTION = true;

layout(scalar, push_constant) uniform Params {
    uint count;      // VPLs
    uint shares;     // VPLs that share the points out: all, or 1 where each has points of its own
    uint capacity;   // points of a partition
    uint considered; // VPLs a point, at most 32
    uint collected;  // of them
    uint columns;    // maps side by side
    float far;       // distance that the maps end at, metres
    float diagonal;
    float enlarge;   // all points
} params;

layout(scalar) readonly buffer Points { Point at[]; } points;
layout(scalar) readonly buffer Fill { uint at[]; } fill;
layout(scalar) readonly buffer Vpls { VplPoint at[]; } vpls;
layout(r32ui) uniform uimage2D target;
layout(scalar) buffer Dropped { uint count; } dropped;
layout(scalar) buffer Drawn { uint count; } drawn;

shared vec3 position[32];
shared mat3 axes[32];
shared ivec2 corner[32];

void main() {
    uint part = gl_WorkGroupID.x, lane = gl_LocalInvocationID.x;
    if (lane < params.considered) {
        uint vpl = (part + lane) % params.count;
        position[lane] = vpls.at[vpl].position;
        axes[lane] = hemisphere(octahedral_snorm16_inverse(vpls.at[vpl].normal));
        corner[lane] = map_corner(vpl, params.columns, int(MAP_SIZE));
    }
    barrier();
    uint held = fill.at[part];
    // Which ones a full partition has lost hangs on the order of the atomics: it draws none.
    if (held > params.capacity) {
        if (lane == 0u) atomicAdd(dropped.count, held);
        held = 0u;
    }
    uint total = 0u;
    for (uint i = lane; i < held; i += 64u) {
        Point point = points.at[part * params.capacity + i];
        vec3 normal = point_normal(point);
        uint seen = 0u;
        for (uint k = 0u; k < params.considered; k++) {
            seen |= uint(point_faces(point, normal, point.position - position[k], axes[k][2])) << k;
        }
        uint passing = bitCount(seen), rest = min(passing, params.collected);
        total += rest;
        float radius = point_radius(point, params.diagonal);
        radius *= params.enlarge * point_enlargement(params.shares, params.considered, passing, max(rest, 1u));
        for (uint k = 0u; k < params.considered; k++) {
            if ((seen >> k & 1u) != 0u && rest > 0u) {
                rest--;
                vec3 way = point.position - position[k];
                float d = length(way);
                vec3 w = way * axes[k] / d;
                vec2 p = paraboloid(w);
                ivec2 texel = clamp(ivec2((p * 0.5 + 0.5) * float(MAP_SIZE)), ivec2(0), ivec2(MAP_SIZE - 1u));
                // A disk seen aslant covers less.
                float seen_radius = DISTORTION ? radius * sqrt(abs(dot(normal, way)) / d) : radius;
                float size = paraboloid_radius(seen_radius, d, w.z, DISTORTION) * (0.5 * float(MAP_SIZE));
                // A texel's middle is not the point's place: it reaches so much farther.
                size = sqrt(size * size + 0.75 * 0.75);
                uint word = pack_pixel(d / params.far, size);
                // Most points lose, and to look first is cheaper than to be told.
                ivec2 at = corner[k] + texel;
                if (word < imageLoad(target, at).r) imageAtomicMin(target, at, word);
            }
        }
    }
    if (total > 0u) atomicAdd(drawn.count, total);
}
