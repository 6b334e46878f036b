#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Irradiance from virtual point lights. Pixels of an n x n pattern take one n^2-th of the VPLs each; a workgroup takes pixels n
// apart, so that all of it runs through the same VPLs while it reads and writes the G-buffer's own pixels (Linke 2016, 4.5).
#include "lib/packing.glsl"
#include "lib/view.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint INTERLEAVE = 1;

layout(scalar, push_constant) uniform Params {
    uint count;
    float squared_min_distance;
} params;

layout(scalar) uniform ViewBlock { View it; } view;
uniform sampler2D depth;
uniform sampler2D normal;
layout(scalar) readonly buffer Points { VplPoint at[]; } points;
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;
layout(rgba16f) writeonly uniform image2D irradiance;

// Of the workgroup's VPLs, unpacked once for all of its pixels.
const uint BATCH = 64;
shared vec4 positions[BATCH];
shared vec4 normals[BATCH];
shared vec4 colors[BATCH];

void main() {
    // Neighbouring workgroups take the sample sets of the same block of pixels.
    uvec2 set = gl_WorkGroupID.xy % INTERLEAVE;
    uvec2 block = gl_WorkGroupID.xy / INTERLEAVE * gl_WorkGroupSize.xy * INTERLEAVE;
    ivec2 pixel = ivec2(block + gl_LocalInvocationID.xy * INTERLEAVE + set);
    const uint SETS = INTERLEAVE * INTERLEAVE;
    uint first = set.y * INTERLEAVE + set.x;
    uint count = first < params.count ? (params.count - first + SETS - 1u) / SETS : 0u;

    bool inside = all(lessThan(uvec2(pixel), uvec2(view.it.width, view.it.height)));
    float z = inside ? texelFetch(depth, pixel, 0).r : 0.0;
    vec3 x = view_position(view.it, pixel, max(z, 1e-30));
    vec3 n = z > 0.0 ? octahedral_inverse(texelFetch(normal, pixel, 0).xy) : vec3(0.0);

    vec3 sum = vec3(0.0);
    for (uint start = 0u; start < count; start += BATCH) {
        uint size = min(BATCH, count - start);
        if (gl_LocalInvocationIndex < size) {
            uint index = first + (start + gl_LocalInvocationIndex) * SETS;
            VplPoint point = points.at[index];
            positions[gl_LocalInvocationIndex] = vec4(point.position, 0.0);
            normals[gl_LocalInvocationIndex] = vec4(octahedral_snorm16_inverse(point.normal), 0.0);
            colors[gl_LocalInvocationIndex] = vec4(intensities.at[index], 0.0);
        }
        barrier();
        for (uint i = 0u; i < size; i++) {
            vec3 v = positions[i].xyz - x;
            float squared = dot(v, v);
            float cosines = max(dot(n, v), 0.0) * max(-dot(normals[i].xyz, v), 0.0);
            sum += colors[i].rgb * (cosines / max(squared * max(squared, params.squared_min_distance), 1e-20));
        }
        barrier();
    }
    if (inside) imageStore(irradiance, pixel, vec4(sum * float(SETS), 1.0));
}
