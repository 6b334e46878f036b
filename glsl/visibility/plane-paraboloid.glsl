// Planes in a paraboloid map. Each part for "plane" defines the depth of a plane at a place of the map, over `far`.
#include "lib/paraboloid.glsl"

float depth_of_plane(vec4 plane, vec2 place) {
    float turned = dot(plane.xyz, paraboloid_inverse(place));
    // A line that misses the plane, or meets it behind the VPL, has no depth.
    return turned * plane.w > 1e-6 * plane.w * plane.w ? plane.w / turned : 1e6;
}
