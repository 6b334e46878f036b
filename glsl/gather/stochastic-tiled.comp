#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
// Stochastic light culling (Tokuyoshi and Harada 2017). A VPL's light at a pixel is kept with probability p and weighted by 1 / p (Russian
// roulette). All pixels share the VPL's random number, so its range has a bound that culls it for whole tiles. A tile is 16 x 16 pixels of
// one sample set, split at the middle of its depth (Stewart 2015). Light lists are bits in shared memory, in the VPLs' order.
#include "part/shadow=gather/shadow-none"
#include "gather/stochastic.glsl"
#include "gather/reflection-ggx.glsl"
#include "lib/range.glsl"

layout(local_size_x = 8, local_size_y = 8) in; // of 2 x 2 pixels of the set each
layout(constant_id = 3) const bool DIFFUSE = true;
layout(constant_id = 4) const bool LOBES = false;
layout(constant_id = 5) const bool CULL = true;

layout(scalar) readonly buffer Spheres { vec4 at[]; } spheres;
layout(scalar) readonly buffer Spheroids { Spheroid at[]; } spheroids;
#include "part/numbers=gather/numbers-none"
layout(rgba16f) writeonly uniform image2D irradiance;
layout(rgba16f) writeonly uniform image2D reflection; // radiance that glossy receivers reflect to the eye

// Tolerance of squared distances: the ends of ranges of alpha 0.001 lobes round to 1.6 % outside of their spheroids.
const float ALLOWANCE = 1.05;
const uint TILE = 16u;
const uint WORDS = 32u; // of a list: 1024 VPLs at a time
const uint INVOCATIONS = 64u;

#include "part/seen=gather/seen-all"

const uint FARTHEST = 0x7f800000u; // bits of infinity

shared uint tile_low; // bits of distances, which sort as these
shared uint tile_high;
shared uint near_low;
shared uint near_high; // bounds of the nearer half
shared uint far_low;
shared uint far_high;
shared uint lists[4][WORDS]; // diffuse near and far, lobes near and far
shared uint filled[4];       // non-zero words of each list

// Bounds of the pixels of one half of the tile, in view space: [low, high] in tangents and in distance.
struct Part {
    vec3 low;
    vec3 high;
};

// Squared distance from a point to the bounding box of a part, after a linear map with the rows row0, row1, (0, 0, depth).
float squared_distance(Part part, vec3 row0, vec3 row1, float depth, vec3 point) {
    vec3 low, high;
    vec2 a = row0.xy * part.low.xy, b = row0.xy * part.high.xy;
    float least = row0.z + min(a.x, b.x) + min(a.y, b.y), most = row0.z + max(a.x, b.x) + max(a.y, b.y);
    low.x = min(least * part.low.z, least * part.high.z);
    high.x = max(most * part.low.z, most * part.high.z);
    a = row1.xy * part.low.xy;
    b = row1.xy * part.high.xy;
    least = row1.z + min(a.x, b.x) + min(a.y, b.y);
    most = row1.z + max(a.x, b.x) + max(a.y, b.y);
    low.y = min(least * part.low.z, least * part.high.z);
    high.y = max(most * part.low.z, most * part.high.z);
    low.z = depth * part.low.z;
    high.z = depth * part.high.z;
    // Slack far above the rounding of this function, and of world positions, which are coarse far from the origin.
    vec3 slack = 2e-6 * max(max(abs(low), abs(high)), abs(point)) +
                 4e-7 * (largest(abs(view.it.position)) + view.it.diagonal) * vec3(dot(abs(row0), vec3(1.0)), dot(abs(row1), vec3(1.0)), depth);
    vec3 off = max(max(low - slack - point, point - high - slack), 0.0);
    return dot(off, off);
}

bool meets_sphere(Part part, vec4 sphere) {
    return part.low.z <= part.high.z && sphere.w > 0.0 &&
           squared_distance(part, vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), 1.0, sphere.xyz) <= sphere.w * sphere.w * ALLOWANCE;
}

bool meets_spheroid(Part part, Spheroid it) {
    return part.low.z <= part.high.z && it.depth != 0.0 && squared_distance(part, it.row0, it.row1, it.depth, it.centre) <= ALLOWANCE;
}

void store(Pixel p) {
    if (!in_picture(p.at.pixel)) return;
    imageStore(irradiance, p.at.pixel, vec4(min(p.sum * float(SETS), LARGEST_HALF), 1.0));
    if (GLOSSY_RECEIVER) imageStore(reflection, p.at.pixel, vec4(min(p.reflected * float(SETS), LARGEST_HALF), 1.0));
    store_numbers(p.at.pixel, vec4(p.numbers));
}

#include "gather/quad.glsl"

void shade(inout Quad q, Diffuse it, vec4 visible) {
    shade(q.a, it, visible.x);
    shade(q.b, it, visible.y);
    shade(q.c, it, visible.z);
    shade(q.d, it, visible.w);
}

void shade(inout Quad q, Glossy it, vec4 visible) {
    shade(q.a, it, visible.x);
    shade(q.b, it, visible.y);
    shade(q.c, it, visible.z);
    shade(q.d, it, visible.w);
}

// Least distance as bits, which sort as distances; those that do not count are ignored.
uint least(vec4 distances, bvec4 counts) {
    vec4 far_off = mix(vec4(uintBitsToFloat(FARTHEST)), distances, counts);
    return floatBitsToUint(min(min(far_off.x, far_off.y), min(far_off.z, far_off.w)));
}

uint most(vec4 distances, bvec4 counts) {
    vec4 at_eye = mix(vec4(0.0), distances, counts);
    return floatBitsToUint(max(max(at_eye.x, at_eye.y), max(at_eye.z, at_eye.w)));
}

// Counts the VPLs of a word on the pixel's lists.
void count_listed(inout Pixel p, uint word) {
    uint list = uint(p.far);
    p.numbers.xz += uvec2(bitCount(lists[list][word]), bitCount(lists[list + 2u][word]));
}

// Cursor over a list: the union of the lists of the tile's halves that the subgroup has pixels in.
struct Cursor {
    uint words; // words with remaining VPLs
    uint word;
    uint bits;  // remaining VPLs of the current word
};

Cursor beginning(uint list, bvec2 halves) {
    return Cursor((halves.x ? filled[list] : 0u) | (halves.y ? filled[list + 1u] : 0u), 0u, 0u);
}

bool has_more(Cursor it) { return (it.words | it.bits) != 0u; }

// Next VPL's number in the list. No loop skips empty words: llvmpipe runs a loop's body once even if its condition fails at first, and ends
// all loops of an invocation together after 65,535 turns.
uint next(inout Cursor it, uint list, bvec2 halves) {
    if (it.bits == 0u) {
        it.word = uint(findLSB(it.words));
        it.words &= it.words - 1u;
        it.bits = (halves.x ? lists[list][it.word] : 0u) | (halves.y ? lists[list + 1u][it.word] : 0u);
    }
    uint bit = uint(findLSB(it.bits));
    it.bits &= it.bits - 1u;
    return it.word * 32u + bit;
}

void put(uint list, uint place) {
    atomicOr(lists[list][place / 32u], 1u << (place % 32u));
    atomicOr(filled[list], 1u << (place / 32u));
}

void main() {
    uint me = gl_LocalInvocationIndex;
    // Neighbouring workgroups process the sample sets of the same block of pixels.
    uvec2 set = gl_WorkGroupID.xy % block_size();
    ivec2 corner = ivec2(gl_WorkGroupID.xy / block_size() * TILE * block_size() + set);
    ivec2 pixel = corner + ivec2(gl_LocalInvocationID.xy * 2u * block_size());
    Quad pixels = quad_at(pixel);

    if (me == 0u) {
        tile_low = near_low = far_low = FARTHEST;
        tile_high = near_high = far_high = 0u;
    }
    barrier();
    vec4 distances = distances_of(pixels);
    bvec4 there = greaterThan(distances, vec4(0.0));
    atomicMin(tile_low, least(distances, there));
    atomicMax(tile_high, most(distances, there));
    barrier();
    float middle = 0.5 * (uintBitsToFloat(tile_low) + uintBitsToFloat(tile_high));
    bvec4 is_far = greaterThan(distances, vec4(middle)), is_near = mix(bvec4(false), lessThanEqual(distances, vec4(middle)), there);
    atomicMin(near_low, least(distances, is_near));
    atomicMax(near_high, most(distances, is_near));
    atomicMin(far_low, least(distances, is_far));
    atomicMax(far_high, most(distances, is_far));
    barrier();
    pixels.a.far = is_far.x;
    pixels.b.far = is_far.y;
    pixels.c.far = is_far.z;
    pixels.d.far = is_far.w;
    bvec2 halves = bvec2(subgroupBallot(any(is_near)) != uvec4(0u), subgroupBallot(any(is_far)) != uvec4(0u));

    vec2 scale = 2.0 / vec2(view.it.width, view.it.height), slope = vec2(length(view.it.right), -length(view.it.up));
    vec2 begin = ((vec2(corner) + 0.5) * scale - 1.0) * slope, end = ((vec2(corner + ivec2((TILE - 1u) * block_size())) + 0.5) * scale - 1.0) * slope;
    vec2 low = min(begin, end), high = max(begin, end);
    Part near = Part(vec3(low, uintBitsToFloat(near_low)), vec3(high, uintBitsToFloat(near_high)));
    Part far = Part(vec3(low, uintBitsToFloat(far_low)), vec3(high, uintBitsToFloat(far_high)));

    uint first = number_of(set);
    uint count = first < params.count ? (params.count - first + SETS - 1u) / SETS : 0u;
    for (uint start = 0u; start < count; start += WORDS * 32u) {
        barrier();
        for (uint i = me; i < 4u * WORDS; i += INVOCATIONS) lists[i / WORDS][i % WORDS] = 0u;
        if (me < 4u) filled[me] = 0u;
        barrier();
        for (uint i = me; i < WORDS * 32u && start + i < count; i += INVOCATIONS) {
            uint index = first + (start + i) * SETS;
            if (DIFFUSE) {
                vec4 sphere = spheres.at[index];
                if (CULL ? meets_sphere(near, sphere) : sphere.w > 0.0) put(0u, i);
                if (CULL ? meets_sphere(far, sphere) : sphere.w > 0.0) put(1u, i);
            }
            if (LOBES) {
                Spheroid it = spheroids.at[index];
                if (CULL ? meets_spheroid(near, it) : it.depth != 0.0) put(2u, i);
                if (CULL ? meets_spheroid(far, it) : it.depth != 0.0) put(3u, i);
            }
        }
        barrier();
        uint words = min(WORDS, (count - start + 31u) / 32u);
        for (uint word = 0u; STATISTICS && word < words; word++) {
            count_listed(pixels.a, word);
            count_listed(pixels.b, word);
            count_listed(pixels.c, word);
            count_listed(pixels.d, word);
        }
        Cursor cursor = beginning(0u, halves);
        while (DIFFUSE && has_more(cursor)) {
            uint place = start + next(cursor, 0u, halves), index = first + place * SETS;
            shade(pixels, diffuse_vpl(index), vec4((seen(pixel, place & ~31u) >> (place % 32u)) & 1u));
        }
        cursor = beginning(2u, halves);
        while (LOBES && has_more(cursor)) {
            uint place = start + next(cursor, 2u, halves), index = first + place * SETS;
            shade(pixels, glossy_vpl(index), vec4((seen(pixel, place & ~31u) >> (place % 32u)) & 1u));
        }
    }
    store(pixels);
}
