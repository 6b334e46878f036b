// Shadows of VPLs by their imperfect shadow maps.
#include "lib/paraboloid.glsl"
#include "visibility/ism.glsl"

layout(scalar) uniform IsmBlock {
    float far;     // the distance that 1 stands for, metres
    float bias;    // widths of a texel
    int size;      // side of a map, texels
    uint columns;  // maps side by side
} ism;
layout(r32f) readonly uniform image2D maps;

struct Shadow {
    vec3 across; // the map's axes
    vec3 up;
    ivec2 corner;
};

Shadow shadow_of(uint vpl, vec3 facing) {
    mat3 axes = hemisphere(facing);
    return Shadow(axes[0], axes[1], map_corner(vpl, ism.columns, ism.size));
}

#define HAND_SHADOW_ROUND(shadow, lane) \
    Shadow(subgroupBroadcast(shadow.across, lane), subgroupBroadcast(shadow.up, lane), subgroupBroadcast(shadow.corner, lane))

float lit(Shadow shadow, vec3 way, float squared, float from, float to) {
    float d = sqrt(squared);
    // 2 (d + from) / size is what a texel's width comes to at the receiver.
    float sum = max(d + from, 1e-12);
    vec2 p = vec2(dot(shadow.across, way), dot(shadow.up, way)) / -sum;
    ivec2 texel = clamp(ivec2((p * 0.5 + 0.5) * float(ism.size)), ivec2(0), ivec2(ism.size - 1));
    float nearest = imageLoad(maps, shadow.corner + texel).r * ism.far;
    // The surface runs deeper across a texel the more it slopes: by its width over the cosine, at most.
    return (d - nearest) * to <= ism.bias * 2.0 / float(ism.size) * sum * d ? 1.0 : 0.0;
}
