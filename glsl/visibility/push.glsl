// Push phase (Linke 2016, section 3.3.2): an invocation fills the four texels of the finer level around a corner of a coarser texel, since
// they are interpolated from the same four. A texel is filled if it is empty, or hidden by the interpolated surface. An includer defines
//     bool finer_texel(ivec2 texel, out float depth);
//     void fill_texel(ivec2 texel, Pulled p);
//     void keep_texel(ivec2 texel, bool there, float depth);
// which load a finer texel's depth and return whether it is filled, store an interpolated texel, and keep a texel.
#include "part/disk=visibility/disk-facing"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const bool CLAMP = true;
// Whether weights fall with the distance of a point from the texel's centre.
layout(constant_id = 1) const bool GAUSSIAN = false;

layout(scalar, push_constant) uniform Params {
    ivec2 size;  // of the finer level
    int tile;    // side of a map in it
    float scale; // texels of this level in one of the finest level
} params;

layout(PULLED_FORMAT) readonly uniform uimage2D coarser;

bool coarser_texel(ivec2 texel, out Pulled p) {
    uvec4 words = imageLoad(coarser, texel);
    p = pulled_from(words);
    return words.x != EMPTY;
}

bool finer_texel(ivec2 texel, out float depth);
void fill_texel(ivec2 texel, Pulled p);
void keep_texel(ivec2 texel, bool there, float depth);

void main() {
    ivec2 corner = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThan(2 * corner, params.size))) return;
    Pulled from[4];
    bool there[4];
    for (int i = 0; i < 4; i++) {
        ivec2 texel = corner - 1 + ivec2(i & 1, i >> 1);
        bool inside = all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(2 * texel, params.size));
        there[i] = coarser_texel(clamp(texel, ivec2(0), params.size / 2 - 1), from[i]) && inside;
        // Offset from the corner, in texels of the finer level.
        from[i].offset = 2.0 * (from[i].offset + vec2(i & 1, i >> 1) - 0.5);
        from[i].radius *= params.scale;
    }
    // Nothing crosses the border between two maps.
    bvec2 seam = bvec2(CLAMP && (2 * corner.x) % params.tile == 0, CLAMP && (2 * corner.y) % params.tile == 0);
    for (int o = 0; o < 4; o++) {
        ivec2 texel = 2 * corner - 1 + ivec2(o & 1, o >> 1);
        vec2 center = vec2(o & 1, o >> 1) - 0.5;
        bool reached[4];
        float depths[4];
        float front = 2.0, limit = 2.0;
        for (int i = 0; i < 4; i++) {
            bool crosses = (seam.x && ((i ^ o) & 1) != 0) || (seam.y && ((i ^ o) & 2) != 0);
            reached[i] = reaches(from[i], center - from[i].offset, texel, params.tile, params.scale, depths[i]) && there[i] && !crosses;
            bool nearer = reached[i] && depths[i] < front;
            limit = nearer ? depths[i] + from[i].extent : limit;
            front = nearer ? depths[i] : front;
        }
        Pulled sum = Pulled(0.0, 0.0, 0.0, vec2(0.0), vec2(0.0));
        float weights = 0.0;
        for (int i = 0; i < 4; i++) {
            // Bilinear weights: 9, 3, 3 and 1 sixteenths.
            float weight = (((i ^ o) & 1) == 0 ? 0.75 : 0.25) * (((i ^ o) & 2) == 0 ? 0.75 : 0.25);
            // The offset is in texels of the finer level.
            if (GAUSSIAN) weight = gaussian_weight(0.5 * (center - from[i].offset));
            weight = reached[i] && depths[i] <= limit ? weight : 0.0;
            sum.depth += weight * depths[i];
            sum.radius += weight * from[i].radius;
            sum.extent = weight > 0.0 ? max(sum.extent, depths[i] + from[i].extent) : sum.extent;
            sum.offset += weight * from[i].offset;
            sum.tilt += weight * from[i].tilt;
            weights += weight;
        }
        if (all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(texel, params.size))) {
            float depth;
            bool kept = finer_texel(texel, depth);
            if (weights > 0.0 && (!kept || depth > sum.extent)) {
                sum.depth /= weights;
                fill_texel(texel, Pulled(sum.depth, sum.radius / (weights * params.scale), max(sum.extent - sum.depth, 0.0),
                                         sum.offset / weights - center, sum.tilt / weights));
            } else {
                keep_texel(texel, kept, depth);
            }
        }
    }
}
