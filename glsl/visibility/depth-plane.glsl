// Depth of a point's plane (Linke 2016, section 5.4.1), no nearer than the point's disk reaches: beyond it the plane would stand before others.
#include "part/plane=visibility/plane-paraboloid"

layout(location = 1) flat in vec4 plane;
layout(location = 2) flat in float nearest;

void put_depth(ivec2 texel) {
    float depth = depth_of_plane(plane, (vec2(texel) + 0.5) * (2.0 / float(MAP_SIZE)) - 1.0);
    gl_FragDepth = 1.0 - clamp(depth, nearest, 1.0);
}
