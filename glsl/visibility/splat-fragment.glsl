// Depth only; clamped splats do not reach into another map.
layout(constant_id = 1) const uint MAP_SIZE = 64;
layout(constant_id = 3) const bool CLAMP = true;

layout(location = 0) flat in ivec2 corner;
#include "part/depth=visibility/depth-center"

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy) - corner;
    if (CLAMP && (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, ivec2(int(MAP_SIZE)))))) discard;
    put_depth(texel);
}
