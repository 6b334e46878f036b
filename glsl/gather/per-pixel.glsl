// Irradiance from virtual point lights. Pixels of an n x n pattern take one n^2-th of the VPLs each; a workgroup takes pixels n
// apart, so that all of it runs through the same VPLs while it reads and writes the G-buffer's own pixels (Linke 2016, 4.5). Whoever includes it
// defines
//     uvec4 seen(ivec2 pixel, uint index);
// which VPLs of the pixel's set, from number `index` on, the pixels see: bit i of a word for VPL index + i, up to the next multiple
// of 32, a word for each of the pixels at the given one, a step across, down, and both; and
//     Shadow shadow_of(uint vpl, vec3 position, vec3 facing);
//     float lit(Shadow shadow, vec3 normal, vec3 way, float squared, float from, float to);
// what a VPL's shadow test needs, and the test: the receiver's normal, `way` to the VPL, its squared length, and the cosines to the VPL's
// normal and to the receiver's, both times the length.
#include "gather/cluster.glsl"
#include "lib/color.glsl"
#include "lib/disk.glsl"
#include "lib/packing.glsl"
#include "lib/view.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 8, local_size_y = 4) in;
layout(constant_id = 0) const uint INTERLEAVE = 1;
layout(constant_id = 3) const bool DISKS = false; // VPLs shine as disks

layout(scalar, push_constant) uniform Params {
    uint count;
    float squared_min_distance;
} params;

layout(scalar) uniform ViewBlock { View it; } view;
uniform sampler2D depth;
uniform sampler2D normal;
layout(scalar) readonly buffer Points { VplPoint at[]; } points;
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) readonly buffer Areas { float at[]; } areas;
layout(rgba16f) writeonly uniform image2D irradiance;

uvec4 seen(ivec2 pixel, uint index);
Shadow shadow_of(uint vpl, vec3 position, vec3 facing);
float lit(Shadow shadow, vec3 normal, vec3 way, float squared, float from, float to);

// A pixel being shaded.
struct Receiver {
    ivec2 pixel;
    vec3 position;
    vec3 normal;
    vec3 sum;
    float distance; // along the view's axis; 0 where there is no surface
};

Receiver receiver(ivec2 pixel) {
    Receiver r = Receiver(pixel, vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    if (all(lessThan(uvec2(pixel), uvec2(view.it.width, view.it.height)))) {
        float z = texelFetch(depth, pixel, 0).r;
        if (z > 0.0) {
            r.position = view_position(view.it, pixel, z);
            r.normal = octahedral_inverse(texelFetch(normal, pixel, 0).xy);
            r.distance = view.it.near / z;
        }
    }
    return r;
}

// A VPL, ready to shine on pixels.
struct Vpl {
    vec3 position;
    vec3 facing;
    vec3 intensity;
    float spread; // square of a disk's radius
    Shadow shadow;
};

// VPL number `index`; one that is not `there` is dark.
Vpl vpl(uint index, bool there) {
    VplPoint point = points.at[index];
    vec3 facing = octahedral_snorm16_inverse(point.normal);
    // Disks reach over their neighbours, as the kernels of a reconstruction do: as far as to the diagonal ones of a grid.
    float spread = 0.0;
    if (DISKS) spread = max(2.0 * areas.at[index], params.squared_min_distance);
    return Vpl(point.position, facing, there ? intensities.at[index] : vec3(0.0), spread, shadow_of(index, point.position, facing));
}

Vpl hand_round(Vpl mine, uint lane) {
    return Vpl(subgroupBroadcast(mine.position, lane), subgroupBroadcast(mine.facing, lane), subgroupBroadcast(mine.intensity, lane),
               subgroupBroadcast(mine.spread, lane), HAND_SHADOW_ROUND(mine.shadow, lane));
}

// A VPL radiates intensity * cosine; d_min bounds what nears infinity as the two points meet, and is the least radius of a disk.
void shade(inout Receiver r, Vpl vpl, float visible) {
    vec3 way = vpl.position - r.position;
    float squared = dot(way, way);
    float from = max(-dot(vpl.facing, way), 0.0), to = max(dot(r.normal, way), 0.0);
    float weight = DISKS ? disk_light(way, vpl.facing, vpl.spread, r.normal)
                         : from * to / max(squared * max(squared, params.squared_min_distance), 1e-20);
    r.sum += vpl.intensity * (weight * visible * lit(vpl.shadow, r.normal, way, squared, from, to));
}

#define HAND_ROUND(lane) { \
    Vpl it = hand_round(mine, lane); \
    vec4 visible = vec4((see >> (lane)) & 1u); \
    shade(a, it, visible.x); \
    shade(b, it, visible.y); \
    shade(c, it, visible.z); \
    shade(d, it, visible.w); \
}

void store(Receiver r) {
    if (any(greaterThanEqual(uvec2(r.pixel), uvec2(view.it.width, view.it.height)))) return;
    imageStore(irradiance, r.pixel, vec4(min(r.sum * float(INTERLEAVE * INTERLEAVE), LARGEST_HALF), 1.0));
}

// Neighbouring workgroups take the sample sets of the same block of pixels. An invocation shades 2 x 2 of its set, so that a VPL is
// fetched once for all four.
uvec2 sample_set() { return gl_WorkGroupID.xy % INTERLEAVE; }

// Of the pixels that a workgroup and those beside it with other sets share out.
ivec2 block_corner(uvec2 group) { return ivec2(group / INTERLEAVE * gl_WorkGroupSize.xy * 2u * INTERLEAVE); }

ivec2 first_pixel() { return block_corner(gl_WorkGroupID.xy) + ivec2(gl_LocalInvocationID.xy * 2u * INTERLEAVE + sample_set()); }
