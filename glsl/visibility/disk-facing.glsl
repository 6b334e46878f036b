// Points without normals: disks that face the VPL. Each part for "disk" defines the following.
#include "visibility/pulled.glsl"

// Share of the squared distances between points that adds to the square of their radius.
const float SPREAD = 1.0;

// Format and words of a texel of a coarser level.
#define PULLED_FORMAT rg32ui
uvec4 pulled_words(Pulled p) { return uvec4(pack_pulled(p), 0u, 0u); }
Pulled pulled_from(uvec4 words) { return unpack_pulled(words.xy); }

// Whether the disk in a texel reaches another texel, `way` from it, and its depth there. The level's maps are `tile` texels wide, and its texels are
// 1 / `scale` of the finest level's.
bool reaches(Pulled p, vec2 way, ivec2 texel, int tile, float scale, out float depth) {
    depth = p.depth;
    return dot(way, way) <= p.radius * p.radius;
}
