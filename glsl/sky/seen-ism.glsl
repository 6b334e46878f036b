// Shadows by a direction's imperfect shadow map, in orthographic projection: glsl/visibility/projection-orthographic.glsl.
#include "gather/ism-lookup.glsl"
#include "visibility/sky-frame.glsl"

layout(scalar) readonly buffer Frames { SkyFrame at[]; } frames;

float sky_seen(uint index, uint within, Receiver r, vec3 facing, float cosine) {
    SkyFrame frame = frames.at[index];
    vec3 from = r.position - places.at[index].position;
    vec2 p = vec2(dot(frame.right, from), dot(frame.up, from));
    // 2 / (scale * size) is the width of a texel.
    float hidden = dot(from, facing) * cosine - ism.bias * 2.0 / (frame.scale * float(ism.size));
    return lit_in_map_at(p, map_corner(index, ism.columns, ism.size), hidden, cosine * ism.far);
}
