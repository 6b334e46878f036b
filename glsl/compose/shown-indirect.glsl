// Intensity of the indirect light in false colour (Barak et al. 2013, figure 5).
#include "lib/false-color.glsl"

vec3 displayed(ivec2 pixel, vec3 picture, vec3 indirect) {
    float exposed = luminance(indirect) * params.exposure;
    return texelFetch(depth, pixel, 0).r > 0.0 ? false_color(exposed / (0.25 + exposed)) : vec3(0.0);
}
