// Without normals a point is a disk that faces the VPL.
#include "visibility/push.glsl"

layout(rg32ui) readonly uniform uimage2D coarser;

bool coarser_texel(ivec2 texel, out Pulled p) {
    uvec2 words = imageLoad(coarser, texel).rg;
    p = unpack_pulled(words);
    return words.x != EMPTY;
}

bool reaches(Pulled p, vec2 way, ivec2 texel, out float depth) {
    depth = p.depth;
    return dot(way, way) <= p.radius * p.radius;
}
