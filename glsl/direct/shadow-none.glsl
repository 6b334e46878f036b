// No shadows, but lights end at the borders of their maps.
#include "direct/in-map.glsl"

float shadow(Light light, uint layer, vec2 uv, float distance) { return 1.0; }
