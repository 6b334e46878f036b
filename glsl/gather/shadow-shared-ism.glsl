// Shadows by the imperfect shadow map of a neighbouring VPL.
#include "gather/ism-lookup.glsl"
#include "lib/basis.glsl"
#include "lib/packing.glsl"
#include "lib/vpl.glsl"

layout(scalar) readonly buffer Labels { uint at[]; } labels;
layout(scalar) readonly buffer Proxies { VplPlace at[]; } proxies;

struct Shadow {
    vec3 across; // the map's axes
    vec3 up;
    vec3 moved;  // from the VPL to the map's place
    ivec2 corner;
};

Shadow shadow_of(uint vpl, vec3 position, vec3 facing) {
    uint label = labels.at[vpl];
    VplPlace proxy = proxies.at[label];
    mat3 axes = basis_of(octahedral_snorm16_inverse(proxy.normal));
    return Shadow(axes[0], axes[1], proxy.position - position, map_corner(label, ism.columns, ism.size));
}

Shadow hand_round(Shadow shadow, uint lane) {
    return Shadow(subgroupBroadcast(shadow.across, lane), subgroupBroadcast(shadow.up, lane), subgroupBroadcast(shadow.moved, lane),
                  subgroupBroadcast(shadow.corner, lane));
}

float lit(Shadow shadow, vec3 normal, vec3 way, float squared, float from, float to) {
    vec3 to_map = way + shadow.moved;
    // Receivers behind the map's plane are looked up at its rim.
    return lit_in_map(shadow.across, shadow.up, shadow.corner, normal, to_map, dot(to_map, to_map),
                      max(-dot(cross(shadow.across, shadow.up), to_map), 0.0), max(dot(normal, to_map), 0.0));
}
