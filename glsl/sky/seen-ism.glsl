// Shadows by a direction's imperfect shadow map, in orthographic projection: glsl/visibility/projection-orthographic.glsl.
#include "gather/ism-lookup.glsl"
#include "visibility/sky-frame.glsl"

layout(scalar) readonly buffer Frames { SkyFrame at[]; } frames;

struct Direction {
    SkyFrame frame;
    vec3 position; // where it leaves the sphere around the scene
    ivec2 corner;  // of its map
};

Direction direction_at(uint index) {
    return Direction(frames.at[index], places.at[index].position, map_corner(index, ism.columns, ism.size));
}

float sky_seen(Direction d, uint within, Receiver r, vec3 facing, float cosine) {
    vec3 from = r.position - d.position;
    vec2 p = vec2(dot(d.frame.right, from), dot(d.frame.up, from));
    // 2 / (scale * size) is the width of a texel.
    float hidden = dot(from, facing) * cosine - ism.bias * 2.0 / (d.frame.scale * float(ism.size));
    return lit_in_map_at(p, d.corner, hidden, cosine * ism.far);
}
