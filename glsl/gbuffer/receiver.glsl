#ifndef RECEIVER_GLSL
#define RECEIVER_GLSL
// The surface at a pixel, as a receiver of light.
#include "lib/packing.glsl"
#include "lib/view.glsl"

layout(scalar) uniform ViewBlock { View it; } view;
uniform sampler2D depth;
uniform sampler2D normal;

struct Receiver {
    ivec2 pixel;
    vec3 position;
    vec3 normal;
    float distance; // along the view's axis; 0 where there is no surface
};

bool in_picture(ivec2 pixel) { return all(lessThan(uvec2(pixel), uvec2(view.it.width, view.it.height))); }

// Receiver at a pixel; there is none beyond the picture.
Receiver receiver(ivec2 pixel) {
    Receiver r = Receiver(pixel, vec3(0.0), vec3(0.0), 0.0);
    if (in_picture(pixel)) {
        float z = texelFetch(depth, pixel, 0).r;
        if (z > 0.0) {
            r.position = view_position(view.it, pixel, z);
            r.normal = octahedral_inverse(texelFetch(normal, pixel, 0).xy);
            r.distance = view.it.near / z;
        }
    }
    return r;
}
#endif
