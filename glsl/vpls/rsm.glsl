#ifndef VPLS_RSM_GLSL
#define VPLS_RSM_GLSL
// Reflective shadow maps as the samplers read them.
#include "lib/light.glsl"

layout(scalar) uniform LightsBlock { Light at[MAX_LIGHTS]; } lights;
uniform sampler2DArray rsm_depth;
uniform sampler2DArray rsm_normal;
uniform sampler2DArray rsm_flux;
uniform sampler2DArray rsm_albedo;
#endif
