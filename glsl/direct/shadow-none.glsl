// No shadows: light arrives everywhere within the lights' maps.
#include "direct/in-map.glsl"

float shadow(Light light, uint layer, vec2 uv, float distance) { return 1.0; }
