// Lookup of a receiver in an imperfect shadow map.
#include "lib/paraboloid.glsl"
#include "visibility/ism.glsl"

layout(constant_id = 2) const bool BILINEAR = true;

layout(scalar) uniform IsmBlock {
    float far;     // distance of the value 1, metres
    float bias;    // widths of a texel
    int size;      // side of a map, texels
    uint columns;  // maps side by side
} ism;
layout(r32f) readonly uniform image2D maps;

// Unoccluded share of a receiver at a place in [-1, 1]^2 of the map with this corner: a texel with value z is open if z * unit >= hidden.
float lit_in_map_at(vec2 p, ivec2 corner, float hidden, float unit) {
    float size = float(ism.size);
    vec2 at = (p * 0.5 + 0.5) * size;
    if (BILINEAR) {
        at = clamp(at - 0.5, 0.0, size - 1.0);
        ivec2 low = ivec2(at);
        ivec2 step = min(low + 1, ivec2(ism.size - 1)) - low;
        ivec2 texel = corner + low;
        vec4 nearest = vec4(imageLoad(maps, texel).r, imageLoad(maps, texel + ivec2(step.x, 0)).r,
                            imageLoad(maps, texel + ivec2(0, step.y)).r, imageLoad(maps, texel + step).r);
        vec4 open = vec4(greaterThanEqual(nearest * unit, vec4(hidden)));
        vec2 within = at - vec2(low);
        vec2 rows = mix(open.xz, open.yw, within.x);
        return mix(rows.x, rows.y, within.y);
    }
    ivec2 texel = clamp(ivec2(at), ivec2(0), ivec2(ism.size - 1));
    return imageLoad(maps, corner + texel).r * unit >= hidden ? 1.0 : 0.0;
}

// Unoccluded share of a receiver. Arguments: the map's axes and corner, the receiver's normal, the vector `way` to the map's place with its
// squared length, and the cosines to the map's normal and to the receiver's, both times the length.
float lit_in_map(vec3 across, vec3 up, ivec2 corner, vec3 normal, vec3 way, float squared, float from, float to) {
    float d = sqrt(squared);
    // 2 (d + from) / size is the width of a texel at the receiver.
    float sum = max(d + from, 1e-12);
    vec2 p = vec2(dot(across, way), dot(up, way)) / -sum;
    // The depth of a sloped surface varies across a texel by at most the texel's width over the cosine.
    return lit_in_map_at(p, corner, d * to - ism.bias * 2.0 / float(ism.size) * sum * d, to * ism.far);
}
