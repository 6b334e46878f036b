// Shadows by percentage-closer filtering (Reeves et al. 1987) over a window of 2 radius + 1 texels.
#include "direct/in-map.glsl"

uniform sampler2DArray shadow_depth;

float shadow(Light light, uint layer, vec2 uv, float distance) {
    vec2 center = uv * vec2(params.map_size);
    float reach = float(params.radius) + 0.5;
    ivec2 low = ivec2(floor(center - reach)), high = ivec2(ceil(center + reach));
    float lit = 0.0, total = 0.0;
    for (int y = low.y; y < high.y; y++) {
        for (int x = low.x; x < high.x; x++) {
            // Area of the texel that the window covers.
            vec2 covered = min(vec2(x, y) + 1.0, center + reach) - max(vec2(x, y), center - reach);
            float weight = covered.x * covered.y;
            ivec2 texel = clamp(ivec2(x, y), ivec2(0), params.map_size - 1);
            float depth = texelFetch(shadow_depth, ivec3(texel, layer), 0).r;
            bool open = depth <= 0.0 || distance <= light_distance(light, depth);
            lit += open ? weight : 0.0;
            total += weight;
        }
    }
    return lit / total;
}
