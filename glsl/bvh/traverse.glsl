// Traversal of the bounding volume hierarchy of src/world/bvh.rs. An includer defines
//     bool is_hole(uint mask, vec2 weights);
// the alpha test of the masked triangle with this mask, at barycentric weights of its second and third corner.
#include "lib/ray.glsl"

layout(constant_id = 105) const bool MASKS = true;        // whether the scene has masked materials
layout(constant_id = 108) const bool SINGLE_SIDES = true; // and single-sided ones

struct Bvh {
    vec3 origin; // lower corner of the boxes' grid
    float padding0;
    vec3 cell;
    float padding1;
};

layout(scalar) uniform BvhBlock { Bvh it; } bvh;
// Storage images, since a software driver computes a mip level for each texel that is fetched from a sampler, which took most of the
// traversal.
layout(rgba32ui) readonly uniform uimage2D bvh_nodes;
layout(rgba32ui) readonly uniform uimage2D bvh_triangles;

const uint LEAF = 0x80000000u;
const uint COUNT_SHIFT = 28u;
const uint STACK = 64u;
const uint NO_TRIANGLE = 0xffffffffu;
const uint DONE = 0xffffffffu;

const uint MASKED = 1u;
const uint SINGLE_SIDED = 2u;
const uint MASK_SHIFT = 2u;

struct Hit {
    float t;         // in units of the ray's direction
    uint triangle;   // number in the hierarchy, or NO_TRIANGLE
    vec2 weights;    // barycentric, of the second and the third corner
};

bool is_hole(uint mask, vec2 weights);

uvec4 node_texel(uint i) { return imageLoad(bvh_nodes, ivec2(i & 4095u, i >> 12)); }
uvec4 triangle_texel(uint i) { return imageLoad(bvh_triangles, ivec2(i & 4095u, i >> 12)); }

// Distances at which a ray enters and leaves a box of the grid. The conversion to float is from signed integers, as processors have it.
vec2 hit_box(uvec3 planes, vec3 scale, vec3 offset) {
    vec3 lower = vec3(ivec3(planes & 0xffffu)) * scale + offset;
    vec3 upper = vec3(ivec3(planes >> 16)) * scale + offset;
    vec3 near = min(lower, upper), far = max(lower, upper);
    return vec2(max(near.x, max(near.y, near.z)), min(far.x, min(far.y, far.z)));
}

// Set if a driver ended a loop early, as llvmpipe does after 65,535 turns of all loops of an invocation together.
bool unfinished = false;

// Nearest hit below a root, from t_min on and before t_max; at equal distances the lower number wins. Holes do not count, nor do backs of
// single-sided surfaces if `from_camera`. `any` returns the first hit found.
Hit traverse(Ray ray, uint root, float t_min, float t_max, bool any, bool from_camera) {
    vec3 scale = bvh.it.cell * ray.inverse;
    vec3 offset = (bvh.it.origin - ray.origin) * ray.inverse;
    uint stack[STACK];
    uint top = 0u;
    Hit hit = Hit(t_max, NO_TRIANGLE, vec2(0.0));
    uint at = root;
    // The texture lookup of masked triangles is outside of the inner loop: all lanes advance to their next masked triangle before any lane
    // looks up a texture.
    while (at != DONE) {
        Hit masked = Hit(0.0, NO_TRIANGLE, vec2(0.0));
        uint mask = 0u;
        while (at != DONE && masked.triangle == NO_TRIANGLE) {
            while (at < LEAF) {
                uvec4 a = node_texel(2u * at), b = node_texel(2u * at + 1u);
                vec2 ta = hit_box(a.xyz, scale, offset), tb = hit_box(b.xyz, scale, offset);
                bool into_a = max(ta.x, t_min) <= min(ta.y, hit.t), into_b = max(tb.x, t_min) <= min(tb.y, hit.t);
                bool a_first = ta.x <= tb.x;
                // Few branches: a driver that runs lanes in lockstep executes both sides, and branches for each lane of a store. The store
                // is unconditional: `top` moves only if both children are hit, else the next push overwrites the entry.
                bool both = into_a && into_b;
                at = both ? (a_first ? a.w : b.w) : into_a ? a.w : b.w;
                stack[top] = a_first ? b.w : a.w;
                top += uint(both);
                if (!into_a && !into_b) {
                    at = top > 0u ? stack[top - 1u] : DONE;
                    top = max(top, 1u) - 1u;
                }
            }
            // A hit masked triangle interrupts the leaf.
            uint i = at & ((1u << COUNT_SHIFT) - 1u), end = at == DONE ? i : i + ((at >> COUNT_SHIFT) & 7u) + 1u;
            while (i < end && masked.triangle == NO_TRIANGLE) {
                vec3 a = uintBitsToFloat(triangle_texel(3u * i).xyz);
                vec3 b = uintBitsToFloat(triangle_texel(3u * i + 1u).xyz);
                uvec4 last = triangle_texel(3u * i + 2u);
                bool front;
                vec3 found = hit_triangle(ray, a, b, uintBitsToFloat(last.xyz), front);
                bool met = found.x >= t_min && (found.x < hit.t || (found.x == hit.t && hit.triangle != NO_TRIANGLE && i < hit.triangle));
                if (SINGLE_SIDES) met = met && (front || !from_camera || (last.w & SINGLE_SIDED) == 0u);
                bool is_masked = false;
                if (MASKS) is_masked = (last.w & MASKED) != 0u;
                if (met && is_masked) {
                    masked = Hit(found.x, i, found.yz);
                    mask = last.w >> MASK_SHIFT;
                } else if (met) {
                    hit = Hit(found.x, i, found.yz);
                }
                i++;
            }
            if (any && hit.triangle != NO_TRIANGLE) {
                at = DONE;
                masked.triangle = NO_TRIANGLE;
            } else if (i < end) {
                at = LEAF | (end - i - 1u) << COUNT_SHIFT | i;
            } else {
                at = top > 0u ? stack[top - 1u] : DONE;
                top = max(top, 1u) - 1u;
            }
        }
        if (MASKS && masked.triangle != NO_TRIANGLE && !is_hole(mask, masked.weights)) {
            hit = masked;
            if (any) at = DONE;
        }
    }
    unfinished = unfinished || at != DONE;
    return hit;
}
