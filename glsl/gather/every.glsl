// The gather without culling: all VPLs of the set.
#include "gather/per-pixel.glsl"

void main() {
    ivec2 pixel = first_pixel();
    const int STEP = int(INTERLEAVE);
    Receiver a = receiver(pixel);
    Receiver b = receiver(pixel + ivec2(STEP, 0));
    Receiver c = receiver(pixel + ivec2(0, STEP));
    Receiver d = receiver(pixel + ivec2(STEP, STEP));

    const uint SETS = INTERLEAVE * INTERLEAVE;
    uint first = sample_set().y * INTERLEAVE + sample_set().x;
    uint count = first < params.count ? (params.count - first + SETS - 1u) / SETS : 0u;
    // Each invocation of a subgroup fetches and unpacks another VPL and hands it round; all add up all of them in the same order,
    // whatever the subgroup's size.
    uint lanes = min(gl_SubgroupSize, 32u);
    for (uint start = 0u; start < count; start += lanes) {
        Vpl mine = vpl(first + min(start + gl_SubgroupInvocationID, count - 1u) * SETS, start + gl_SubgroupInvocationID < count);
        uvec4 see = seen(pixel, start);
        // Four at a time: llvmpipe ends all loops of an invocation together after 65,535 turns.
        for (uint lane = 0u; lane < lanes; lane += 4u) {
            HAND_ROUND(lane)
            HAND_ROUND(lane + 1u)
            HAND_ROUND(lane + 2u)
            HAND_ROUND(lane + 3u)
        }
    }
    store(a);
    store(b);
    store(c);
    store(d);
}
