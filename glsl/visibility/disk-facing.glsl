// Without normals a point is a disk that faces the VPL. Each part for "disk" defines the following.
#include "visibility/pulled.glsl"

// How much of the square of the distances between points adds to their radius's.
const float SPREAD = 1.0;

// How a texel of a coarser level is stored.
#define PULLED_FORMAT rg32ui
uvec4 pulled_words(Pulled p) { return uvec4(pack_pulled(p), 0u, 0u); }
Pulled pulled_from(uvec4 words) { return unpack_pulled(words.xy); }

// Whether what is in a texel reaches another one of maps `tile` texels wide, `way` from it in texels of which one of the finest level's has
// `scale`; and how far off it is there.
bool reaches(Pulled p, vec2 way, ivec2 texel, int tile, float scale, out float depth) {
    depth = p.depth;
    return dot(way, way) <= p.radius * p.radius;
}
