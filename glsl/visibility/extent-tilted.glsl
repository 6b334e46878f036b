// Depth interval of single pixels with tilts.
#include "visibility/tilt.glsl"

layout(r32ui) readonly uniform uimage2D tilts;

void put_extent(ivec2 texel, vec2 place, inout Pulled p) {
    p.tilt = unpack_tilt(imageLoad(tilts, texel).r);
    // The interval is the depth of the tilted disk in the world; the projection's scale is undone.
    float scale = 4.0;
    if (DISTORTION) scale = 4.0 / (1.0 + dot(place, place));
    p.extent = 2.0 * max(length(p.tilt), 0.5) * p.radius * p.depth * scale / float(MAP_SIZE);
}
