// VPLs.
#include "lib/vpl.glsl"

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Areas { float at[]; } areas;

bool is_marked(uint index) { return areas.at[index] > 0.0; }
vec3 place_of(uint index) { return places.at[index].position; }
