// The picture, darkened, under the VPLs of the first bounce that the camera sees, in false colour by their radiant intensity.
#include "lib/false-color.glsl"

layout(scalar) readonly buffer Marks { uint at[]; } marks; // number of a pixel's VPL, plus 1
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;

vec3 displayed(ivec2 pixel, vec3 picture, vec3 indirect) {
    uint mark = marks.at[uint(pixel.y) * view.it.width + uint(pixel.x)];
    if (mark == 0u) return 0.4 * picture;
    float exposed = luminance(intensities.at[mark - 1u]) * params.exposure;
    return false_color(exposed / (1.0 + exposed));
}
