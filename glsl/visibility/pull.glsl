// Pull phase (Linke 2016, section 3.3.2): a texel of the coarser level is the mean of those of the four below it that lie in the depth
// interval of the frontmost. An includer defines
//     bool finer_texel(ivec2 texel, out Pulled p);
// which loads a texel of the finer level, and returns whether it is filled.
#include "part/disk=visibility/disk-facing"

layout(local_size_x = 8, local_size_y = 8) in;
// Share of the points' mean squared distance that is added to their squared radius.
layout(constant_id = 2) const float SPREAD = 1.0;
// Whether weights fall with the distance of a point from the texel's centre.
layout(constant_id = 3) const bool GAUSSIAN = false;

layout(scalar, push_constant) uniform Params {
    ivec2 size;  // of the coarser level
    float texel; // its width, in texels of the finest
} params;

layout(PULLED_FORMAT) writeonly uniform uimage2D coarser;

bool finer_texel(ivec2 texel, out Pulled p);

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, params.size))) return;
    Pulled from[4];
    bool there[4];
    float front = 2.0, limit = 2.0;
    for (int i = 0; i < 4; i++) {
        there[i] = finer_texel(2 * texel + ivec2(i & 1, i >> 1), from[i]);
        bool nearer = there[i] && from[i].depth < front;
        limit = nearer ? from[i].depth + from[i].extent : limit;
        front = nearer ? from[i].depth : front;
    }
    Pulled sum = Pulled(0.0, 0.0, 0.0, vec2(0.0), vec2(0.0));
    float count = 0.0, spread = 0.0;
    for (int i = 0; i < 4; i++) {
        // Offset in texels of the coarser level, from its centre.
        vec2 place = 0.5 * (from[i].offset + vec2(i & 1, i >> 1) - 0.5);
        float weight = GAUSSIAN ? gaussian_weight(place) : 1.0;
        if (!(there[i] && from[i].depth <= limit)) weight = 0.0;
        sum.depth += weight * from[i].depth;
        sum.radius += weight * from[i].radius;
        sum.extent = weight > 0.0 ? max(sum.extent, from[i].depth + from[i].extent) : sum.extent;
        sum.offset += weight * place;
        spread += weight * dot(place, place);
        sum.tilt += weight * from[i].tilt;
        count += weight;
    }
    float over = count > 0.0 ? 1.0 / count : 0.0;
    sum.depth *= over;
    sum.radius *= over;
    sum.offset *= over;
    // Points that lie apart cover more together, to leave no holes between them.
    spread = max(spread * over - dot(sum.offset, sum.offset), 0.0) * SPREAD * params.texel * params.texel;
    sum.radius = sqrt(sum.radius * sum.radius + spread);
    Pulled mean = Pulled(sum.depth, sum.radius, max(sum.extent - sum.depth, 0.0), sum.offset, sum.tilt * over);
    imageStore(coarser, texel, count > 0.0 ? pulled_words(mean) : uvec4(EMPTY, EMPTY, 0u, 0u));
}
