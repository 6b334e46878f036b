// Maps of all of the scene from infinitely far away. VPLs are outside of the scene and face its centre.
#include "lib/paraboloid.glsl"
#include "visibility/sky-frame.glsl"

layout(scalar) readonly buffer Frames { SkyFrame at[]; } frames;

vec3 sight(vec3 from, vec3 facing) { return facing * max(dot(from, facing), 1e-6); }

// Both sides of a surface stop light: that of a room's walls may never see the sky. Edge-on points cover nothing.
bool is_in_the_way(Point point, vec3 normal, vec3 way, vec3 facing) { return abs(dot(normal, facing)) > 0.01; }

vec2 place_in_map(uint vpl, vec3 from, vec3 w) { return vec2(dot(frames.at[vpl].right, from), dot(frames.at[vpl].up, from)); }

// Steps of the place by one are steps in the world, since a frame's vectors are at right angles.
vec3 plane_in_map(uint vpl, vec3 normal, mat3 axes) {
    vec3 right = frames.at[vpl].right, up = frames.at[vpl].up;
    return vec3(dot(normal, right) / dot(right, right), dot(normal, up) / dot(up, up), dot(normal, axes[2]));
}

float radius_in_map(uint vpl, float r, float d, float cosine) { return r * frames.at[vpl].scale; }
