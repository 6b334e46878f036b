// Texels that are all as important. Each part for "importance" includes vpls/at-once.glsl and defines
//     void importances(ivec3 at[AT_ONCE], uvec2 size, out float found[AT_ONCE]);
#include "vpls/at-once.glsl"

void importances(ivec3 at[AT_ONCE], uvec2 size, out float found[AT_ONCE]) {
    for (uint k = 0u; k < AT_ONCE; k++) found[k] = 1.0;
}
