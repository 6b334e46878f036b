// Enclosure of a texel of a reflective shadow map by the scene. An includer has the map's depths:
//     uniform sampler2DArray rsm_depth;
#include "lib/hammersley.glsl"
#include "lib/light.glsl"

layout(constant_id = 0) const bool MORE_BESIDE = false; // whether the scene extends beyond a directional light's map
const uint ENCLOSURE_STEPS = 10u; // of a ray

// Whether a ray hits the map's surface, taken as an infinitely thick height field. Beyond a lamp's cone, and beyond a part of the scene
// that a directional light's map is restricted to, it counts as a hit; beyond the whole scene, and above the map, as a miss (sky).
bool meets(Light light, uint layer, ivec2 size, vec3 from, vec3 way, float texel_width) {
    float t = 2.0 * texel_width;
    float growth = pow(max(0.5 * float(max(size.x, size.y)), 1.0), 1.0 / float(ENCLOSURE_STEPS - 1u));
    for (uint i = 0u; i < ENCLOSURE_STEPS; i++) {
        vec4 clip = light.world_to_clip * vec4(from + way * t, 1.0);
        if (clip.w <= 0.0) return true;
        vec3 at = clip.xyz / clip.w;
        if (any(greaterThan(abs(at.xy), vec2(1.0)))) return light.kind != DIRECTIONAL || MORE_BESIDE;
        if (at.z > 1.0) return light.kind != DIRECTIONAL;
        ivec2 texel = min(ivec2((at.xy * 0.5 + 0.5) * vec2(size)), size - 1);
        if (at.z < texelFetch(rsm_depth, ivec3(texel, layer), 0).r) return true;
        t *= growth;
    }
    return false;
}

// Share of a surface's reflected light that hits the scene again: `rays` of a cosine-weighted set of `all`.
float enclosure(Light light, uint layer, ivec2 size, vec3 position, vec3 normal, float texel_width, uint first, uint rays, uint all) {
    uint met = 0u;
    for (uint j = first; j < first + rays; j++) {
        // Points of a sphere tangent to the surface, which are cosine-weighted.
        vec2 u = hammersley(j, all);
        float z = 1.0 - 2.0 * u.x, r = sqrt(max(1.0 - z * z, 0.0)), angle = 6.28318530718 * u.y;
        vec3 way = normalize(normal * 1.001 + vec3(r * cos(angle), r * sin(angle), z));
        met += uint(meets(light, layer, size, position + normal * (2.0 * texel_width), way, texel_width));
    }
    return float(met) / float(rays);
}
