// Irradiance from virtual point lights. Pixels of an n x n pattern take one n^2-th of the VPLs each; a workgroup takes pixels n
// apart, so that all of it runs through the same VPLs while it reads and writes the G-buffer's own pixels (Linke 2016, 4.5). Whoever includes it
// defines
//     uvec4 seen(ivec2 pixel, uint index);
// which of four VPLs of the pixel's set, from number `index` on, the pixels see: bit i of a word for VPL index + i, a word for each
// of the pixels at the given one, a step across, down, and both; and
//     Shadow shadow_of(uint vpl, vec3 facing);
//     float lit(Shadow shadow, vec3 way, float squared, float from, float to);
// what a VPL's shadow test needs, and the test: `way` to the VPL, its squared length, and the cosines to the VPL's normal and to the
// receiver's, both times the length.
#include "lib/color.glsl"
#include "lib/packing.glsl"
#include "lib/view.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 8, local_size_y = 4) in;
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

uvec4 seen(ivec2 pixel, uint index);
Shadow shadow_of(uint vpl, vec3 facing);
float lit(Shadow shadow, vec3 way, float squared, float from, float to);

// A pixel being shaded.
struct Receiver {
    ivec2 pixel;
    vec3 position;
    vec3 normal;
    vec3 sum;
};

Receiver receiver(ivec2 pixel) {
    Receiver r = Receiver(pixel, vec3(0.0), vec3(0.0), vec3(0.0));
    if (all(lessThan(uvec2(pixel), uvec2(view.it.width, view.it.height)))) {
        float z = texelFetch(depth, pixel, 0).r;
        if (z > 0.0) {
            r.position = view_position(view.it, pixel, z);
            r.normal = octahedral_inverse(texelFetch(normal, pixel, 0).xy);
        }
    }
    return r;
}

// A VPL, ready to shine on pixels.
struct Vpl {
    vec3 position;
    vec3 facing;
    vec3 intensity;
    Shadow shadow;
};

// A VPL radiates intensity * cosine; d_min bounds what nears infinity as the two points meet.
void shade(inout Receiver r, Vpl vpl, float visible) {
    vec3 way = vpl.position - r.position;
    float squared = dot(way, way);
    float from = max(-dot(vpl.facing, way), 0.0), to = max(dot(r.normal, way), 0.0);
    float weight = from * to * visible / max(squared * max(squared, params.squared_min_distance), 1e-20);
    r.sum += vpl.intensity * (weight * lit(vpl.shadow, way, squared, from, to));
}

#define HAND_ROUND(lane, i) { \
    Vpl vpl = hand_round(mine, lane + i); \
    vec4 visible = vec4((see >> i) & 1u); \
    shade(a, vpl, visible.x); \
    shade(b, vpl, visible.y); \
    shade(c, vpl, visible.z); \
    shade(d, vpl, visible.w); \
}

Vpl hand_round(Vpl mine, uint lane) {
    return Vpl(subgroupBroadcast(mine.position, lane), subgroupBroadcast(mine.facing, lane), subgroupBroadcast(mine.intensity, lane),
               HAND_SHADOW_ROUND(mine.shadow, lane));
}

void store(Receiver r) {
    if (any(greaterThanEqual(uvec2(r.pixel), uvec2(view.it.width, view.it.height)))) return;
    imageStore(irradiance, r.pixel, vec4(min(r.sum * float(INTERLEAVE * INTERLEAVE), LARGEST_HALF), 1.0));
}

void main() {
    // Neighbouring workgroups take the sample sets of the same block of pixels. An invocation shades 2 x 2 of its set, so that a
    // VPL is fetched once for all four.
    uvec2 set = gl_WorkGroupID.xy % INTERLEAVE;
    uvec2 block = gl_WorkGroupID.xy / INTERLEAVE * gl_WorkGroupSize.xy * 2u * INTERLEAVE;
    ivec2 pixel = ivec2(block + gl_LocalInvocationID.xy * 2u * INTERLEAVE + set);
    const int STEP = int(INTERLEAVE);
    Receiver a = receiver(pixel);
    Receiver b = receiver(pixel + ivec2(STEP, 0));
    Receiver c = receiver(pixel + ivec2(0, STEP));
    Receiver d = receiver(pixel + ivec2(STEP, STEP));

    const uint SETS = INTERLEAVE * INTERLEAVE;
    uint first = set.y * INTERLEAVE + set.x;
    uint count = first < params.count ? (params.count - first + SETS - 1u) / SETS : 0u;
    // Each invocation of a subgroup fetches and unpacks another VPL and hands it round; all add up all of them in the same order,
    // whatever the subgroup's size.
    uint lanes = min(gl_SubgroupSize, gl_WorkGroupSize.x * gl_WorkGroupSize.y);
    for (uint start = 0u; start < count; start += lanes) {
        uint index = first + min(start + gl_SubgroupInvocationID, count - 1u) * SETS;
        VplPoint point = points.at[index];
        vec3 facing = octahedral_snorm16_inverse(point.normal);
        vec3 intensity = start + gl_SubgroupInvocationID < count ? intensities.at[index] : vec3(0.0);
        Vpl mine = Vpl(point.position, facing, intensity, shadow_of(index, facing));
        // Four at a time: llvmpipe ends all loops of an invocation together after 65,535 turns.
        for (uint lane = 0u; lane < lanes; lane += 4u) {
            uvec4 see = seen(pixel, start + lane);
            HAND_ROUND(lane, 0u)
            HAND_ROUND(lane, 1u)
            HAND_ROUND(lane, 2u)
            HAND_ROUND(lane, 3u)
        }
    }
    store(a);
    store(b);
    store(c);
    store(d);
}
