#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Marks the pixels around each light that the camera sees. Of several lights, the last has the pixel. A part for "marked" defines
//     bool is_marked(uint index);
//     vec3 place_of(uint index);
// which say whether light `index` shines, and where it is.
#include "lib/view.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params {
    uint count;
    int radius; // pixels
} params;

layout(scalar) uniform ViewBlock { View it; } view;
uniform sampler2D depth;
layout(scalar) buffer Marks { uint at[]; } marks;

#include "part/marked=compose/marked-vpls"

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count || !is_marked(index)) return;
    vec4 clip = view.it.view_projection * vec4(place_of(index), 1.0);
    // The clip's w is the distance along the view's axis.
    if (clip.w <= view.it.near) return;
    ivec2 size = ivec2(view.it.width, view.it.height);
    vec2 at = (clip.xy / clip.w * 0.5 + 0.5) * vec2(size);
    if (any(lessThan(at, vec2(0.0))) || any(greaterThanEqual(at, vec2(size)))) return;
    ivec2 centre = min(ivec2(at), size - 1);
    float nearest = view.it.near / max(texelFetch(depth, centre, 0).r, 1e-20);
    if (clip.w > 1.02 * nearest) return;
    for (int y = -params.radius; y <= params.radius; y++) {
        for (int x = -params.radius; x <= params.radius; x++) {
            ivec2 pixel = centre + ivec2(x, y);
            bool inside = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, size));
            if (inside && x * x + y * y <= params.radius * (params.radius + 1)) {
                atomicMax(marks.at[uint(pixel.y * size.x + pixel.x)], index + 1u);
            }
        }
    }
}
