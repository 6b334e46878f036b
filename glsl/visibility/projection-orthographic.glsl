// Maps of all of the scene from infinitely far away. VPLs are outside of the scene and face its centre.
#include "lib/paraboloid.glsl"
#include "visibility/sky-frame.glsl"

layout(scalar) readonly buffer Frames { SkyFrame at[]; } frames;

vec3 sight(vec3 from, vec3 facing) { return facing * max(dot(from, facing), 1e-6); }

// Both sides of a surface stop light: that of a room's walls may never see the sky. Edge-on points cover nothing.
bool is_in_the_way(Point point, vec3 normal, vec3 way, vec3 facing) { return abs(dot(normal, facing)) > 0.01; }

vec2 place_in_map(uint vpl, vec3 from, vec3 w) { return vec2(dot(frames.at[vpl].right, from), dot(frames.at[vpl].up, from)); }

// Steps of the place by one, over `far` as depths are. A frame's vectors are at right angles.
vec3 plane_in_map(uint vpl, vec3 normal, mat3 axes) {
    SkyFrame frame = frames.at[vpl];
    vec2 steps = vec2(dot(normal, frame.right) / dot(frame.right, frame.right), dot(normal, frame.up) / dot(frame.up, frame.up));
    return vec3(steps * (frame.extent * frame.scale), dot(normal, axes[2]));
}

float radius_in_map(uint vpl, float r, float d, float cosine) { return r * frames.at[vpl].scale; }
