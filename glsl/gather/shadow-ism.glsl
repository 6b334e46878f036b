// Shadows by each VPL's imperfect shadow map (Linke 2016, section 3.3).
#include "gather/ism-lookup.glsl"
#include "lib/basis.glsl"

struct Shadow {
    vec3 across; // the map's axes
    vec3 up;
    ivec2 corner;
};

Shadow shadow_of(uint vpl, vec3 position, vec3 facing) {
    mat3 axes = basis_of(facing);
    return Shadow(axes[0], axes[1], map_corner(vpl, ism.columns, ism.size));
}

Shadow hand_round(Shadow shadow, uint lane) {
    return Shadow(subgroupBroadcast(shadow.across, lane), subgroupBroadcast(shadow.up, lane), subgroupBroadcast(shadow.corner, lane));
}

float lit(Shadow shadow, vec3 normal, vec3 way, float squared, float from, float to) {
    return lit_in_map(shadow.across, shadow.up, shadow.corner, normal, way, squared, from, to);
}
