// Shadows by variance shadow maps (Donnelly and Lauritzen 2006).
#include "direct/in-map.glsl"

uniform sampler2DArray moments;

// Cut-off of the bound's lower tail, which reduces light bleeding.
const float BLEEDING = 0.3;

float shadow(Light light, uint layer, vec2 uv, float distance) {
    vec2 m = texture(moments, vec3(uv, layer)).rg;
    if (distance <= m.x) return 1.0;
    // The variance is at least the bias, and the rounding of 32 bits.
    float variance = max(m.y - m.x * m.x, params.bias * params.bias * 0.25 + 3e-7 * m.y);
    float excess = distance - m.x;
    float bound = variance / (variance + excess * excess);
    return clamp((bound - BLEEDING) / (1.0 - BLEEDING), 0.0, 1.0);
}
