// Points without normals: disks that face the VPL. Each part for "disk" defines the following.
#include "visibility/pulled.glsl"

// Storage of a texel of a coarser level.
#define PULLED_FORMAT rg32ui
uvec4 pulled_words(Pulled p) { return uvec4(pack_pulled(p), 0u, 0u); }
Pulled pulled_from(uvec4 words) { return unpack_pulled(words.xy); }

// Whether a texel's disk covers another texel, at the vector `way` from it, in a map of `tile` texels; `depth` is its depth there. `way` is
// in texels of this level, of which a texel of the finest level is `scale`.
bool reaches(Pulled p, vec2 way, ivec2 texel, int tile, float scale, out float depth) {
    depth = p.depth;
    return dot(way, way) <= p.radius * p.radius;
}
