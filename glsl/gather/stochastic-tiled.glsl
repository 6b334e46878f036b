// Stochastic light culling (Tokuyoshi and Harada 2017): a VPL's light at a pixel counts with the probability p that it is worth, and then
// 1 / p times, by one random number a VPL, so that what bounds its range culls it for whole tiles. A tile is 16 x 16 pixels of one sample
// set, halved at the middle of its depth (Stewart 2015). The lists are bits in shared memory, in the VPLs' order. Whoever includes
// it defines `seen`, as for gather/per-pixel.glsl.
#include "gather/stochastic.glsl"
#include "lib/range.glsl"

layout(local_size_x = 8, local_size_y = 8) in; // of 2 x 2 pixels of the set each
layout(constant_id = 3) const bool DIFFUSE = true;
layout(constant_id = 4) const bool LOBES = false;
layout(constant_id = 5) const bool CULL = true;
layout(constant_id = 6) const bool STATISTICS = false;
layout(constant_id = 7) const bool GLOSSY_RECEIVER = false;
layout(constant_id = 8) const bool GLOSSY_DIELECTRIC = false;

layout(scalar) readonly buffer Spheres { vec4 at[]; } spheres;
layout(scalar) readonly buffer Spheroids { Spheroid at[]; } spheroids;
layout(rgba32f) writeonly uniform image2D numbers; // VPLs on the pixel's list and VPLs that count; of diffuse ones, then of lobes
layout(rgba16f) writeonly uniform image2D irradiance;
uniform sampler2D albedo;
uniform sampler2D metallic_roughness;
layout(rgba16f) writeonly uniform image2D reflection; // radiance that the pixels' own gloss reflects to the eye

// By how much squared distances may be over: lobes of alpha 0.001 round to ends of ranges 1.6 % outside of their spheroids.
const float ALLOWANCE = 1.05;
const uint TILE = 16u;
const uint WORDS = 32u; // of a list: 1024 VPLs at a time
const uint INVOCATIONS = 64u;

uvec4 seen(ivec2 pixel, uint index);

// The surface is looked up anew for each light, since most are never reflected so.
float reflect_from(inout Receiver r, vec3 light, vec3 to_light) {
    float left = 1.0;
    if (GLOSSY_RECEIVER) {
        vec3 base = texelFetch(albedo, r.pixel, 0).rgb;
        vec2 mr = texelFetch(metallic_roughness, r.pixel, 0).rg;
        vec3 f0 = mr.x * base;
        float f90 = mr.x;
        if (GLOSSY_DIELECTRIC) {
            f0 += (1.0 - mr.x) * 0.04;
            f90 = 1.0;
        }
        if (f90 > 0.0) {
            vec3 v = normalize(view.it.position - r.position), h = normalize(to_light + v);
            float nv = max(dot(r.normal, v), 1e-4);
            if (GLOSSY_DIELECTRIC && mr.x < 1.0) left = 1.0 - coat_fresnel(dot(v, h));
            r.reflected += light * lobe_fresnel(f0, f90, dot(v, h)) *
                           ggx(max(mr.y * mr.y, 1e-3), max(dot(r.normal, h), 0.0), max(dot(r.normal, to_light), 0.0), nv);
        }
    }
    return left;
}

shared uint near_low;  // bits of distances, which are in their order
shared uint near_high; // of the nearer half
shared uint far_low;
shared uint far_high;
shared uint lists[4][WORDS]; // diffuse near and far, lobes near and far

// What the tile's pixels of one half span, in the view's space: [low, high] in tangents to the sides, and in distance.
struct Part {
    vec3 low;
    vec3 high;
};

// Square of the distance from a point to the box around a part that a matrix of rows row0, row1, (0, 0, depth) has taken elsewhere.
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
    // Rounding moves both by far less than this: here, and in the world, far from whose origin places are coarse.
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

void store(Receiver r) {
    if (any(greaterThanEqual(uvec2(r.pixel), uvec2(view.it.width, view.it.height)))) return;
    imageStore(irradiance, r.pixel, vec4(min(r.sum * float(INTERLEAVE * INTERLEAVE), LARGEST_HALF), 1.0));
    if (GLOSSY_RECEIVER) imageStore(reflection, r.pixel, vec4(min(r.reflected * float(INTERLEAVE * INTERLEAVE), LARGEST_HALF), 1.0));
    if (STATISTICS) imageStore(numbers, r.pixel, vec4(r.numbers));
}

void widen(Receiver r, float middle) {
    if (r.distance <= 0.0) return;
    uint bits = floatBitsToUint(r.distance);
    if (r.distance <= middle) {
        atomicMin(near_low, bits);
        atomicMax(near_high, bits);
    } else {
        atomicMin(far_low, bits);
        atomicMax(far_high, bits);
    }
}

uint count_bits(Receiver r, uint which, uint word) { return uint(bitCount(lists[which + uint(r.far)][word])); }

void main() {
    const uint N = INTERLEAVE, SETS = INTERLEAVE * INTERLEAVE;
    uint me = gl_LocalInvocationIndex;
    // Neighbouring workgroups take the sample sets of the same block of pixels.
    uvec2 set = gl_WorkGroupID.xy % N;
    ivec2 corner = ivec2(gl_WorkGroupID.xy / N * TILE * N + set);
    ivec2 pixel = corner + ivec2(gl_LocalInvocationID.xy * 2u * N);
    Receiver a = receiver(pixel);
    Receiver b = receiver(pixel + ivec2(N, 0));
    Receiver c = receiver(pixel + ivec2(0, N));
    Receiver d = receiver(pixel + ivec2(N, N));

    if (me == 0u) {
        near_low = far_low = 0x7f800000u;
        near_high = far_high = 0u;
    }
    barrier();
    // All are nearer than this.
    widen(a, 3e38);
    widen(b, 3e38);
    widen(c, 3e38);
    widen(d, 3e38);
    barrier();
    float middle = 0.5 * (uintBitsToFloat(near_low) + uintBitsToFloat(near_high));
    barrier();
    if (me == 0u) {
        near_low = 0x7f800000u;
        near_high = 0u;
    }
    barrier();
    widen(a, middle);
    widen(b, middle);
    widen(c, middle);
    widen(d, middle);
    barrier();
    a.far = a.distance > middle;
    b.far = b.distance > middle;
    c.far = c.distance > middle;
    d.far = d.distance > middle;
    bool has_near = subgroupBallot((a.distance > 0.0 && !a.far) || (b.distance > 0.0 && !b.far) || (c.distance > 0.0 && !c.far) ||
                                   (d.distance > 0.0 && !d.far)) != uvec4(0u);
    bool has_far = subgroupBallot(a.far || b.far || c.far || d.far) != uvec4(0u);

    vec2 scale = 2.0 / vec2(view.it.width, view.it.height), slope = vec2(length(view.it.right), -length(view.it.up));
    vec2 begin = ((vec2(corner) + 0.5) * scale - 1.0) * slope, end = ((vec2(corner + int((TILE - 1u) * N)) + 0.5) * scale - 1.0) * slope;
    vec2 low = min(begin, end), high = max(begin, end);
    Part near = Part(vec3(low, uintBitsToFloat(near_low)), vec3(high, uintBitsToFloat(near_high)));
    Part far = Part(vec3(low, uintBitsToFloat(far_low)), vec3(high, uintBitsToFloat(far_high)));

    uint first = set.y * N + set.x;
    uint count = first < params.count ? (params.count - first + SETS - 1u) / SETS : 0u;
    for (uint start = 0u; start < count; start += WORDS * 32u) {
        barrier();
        for (uint i = me; i < 4u * WORDS; i += INVOCATIONS) lists[i / WORDS][i % WORDS] = 0u;
        barrier();
        for (uint i = me; i < WORDS * 32u && start + i < count; i += INVOCATIONS) {
            uint index = first + (start + i) * SETS, word = i / 32u, bit = 1u << (i % 32u);
            if (DIFFUSE) {
                vec4 sphere = spheres.at[index];
                if (CULL ? meets_sphere(near, sphere) : sphere.w > 0.0) atomicOr(lists[0][word], bit);
                if (CULL ? meets_sphere(far, sphere) : sphere.w > 0.0) atomicOr(lists[1][word], bit);
            }
            if (LOBES) {
                Spheroid it = spheroids.at[index];
                if (CULL ? meets_spheroid(near, it) : it.depth != 0.0) atomicOr(lists[2][word], bit);
                if (CULL ? meets_spheroid(far, it) : it.depth != 0.0) atomicOr(lists[3][word], bit);
            }
        }
        barrier();
        for (uint word = 0u; word < WORDS && start + word * 32u < count; word++) {
            uint diffuse = (has_near ? lists[0][word] : 0u) | (has_far ? lists[1][word] : 0u);
            uint glossy = (has_near ? lists[2][word] : 0u) | (has_far ? lists[3][word] : 0u);
            uvec4 see = uvec4(0u);
            if ((diffuse | glossy) != 0u) see = seen(pixel, start + word * 32u);
            if (STATISTICS) {
                a.numbers.xz += uvec2(count_bits(a, 0u, word), count_bits(a, 2u, word));
                b.numbers.xz += uvec2(count_bits(b, 0u, word), count_bits(b, 2u, word));
                c.numbers.xz += uvec2(count_bits(c, 0u, word), count_bits(c, 2u, word));
                d.numbers.xz += uvec2(count_bits(d, 0u, word), count_bits(d, 2u, word));
            }
            while (DIFFUSE && diffuse != 0u) {
                uint bit = uint(findLSB(diffuse));
                diffuse &= diffuse - 1u;
                uint index = first + (start + word * 32u + bit) * SETS;
                Diffuse it = diffuse_vpl(index);
                vec4 visible = vec4((see >> bit) & 1u);
                shade(a, it, visible.x);
                shade(b, it, visible.y);
                shade(c, it, visible.z);
                shade(d, it, visible.w);
            }
            while (LOBES && glossy != 0u) {
                uint bit = uint(findLSB(glossy));
                glossy &= glossy - 1u;
                uint index = first + (start + word * 32u + bit) * SETS;
                Glossy it = glossy_vpl(index);
                vec4 visible = vec4((see >> bit) & 1u);
                shade(a, it, visible.x);
                shade(b, it, visible.y);
                shade(c, it, visible.z);
                shade(d, it, visible.w);
            }
        }
    }
    store(a);
    store(b);
    store(c);
    store(d);
}
