#ifndef LIGHT_GLSL
#define LIGHT_GLSL
// A layer of the reflective shadow map: a light, or one face of a point light, with its projection. The host's type is `Projector` of
// src/world/projection.rs.
#include "lib/exact.glsl"
struct Light {
    mat4 world_to_clip;
    vec3 origin;    // the light's position, or the centre of a directional light's near plane
    uint kind;
    vec3 direction; // direction of light, along the map's axis
    float near;     // of the reversed, infinite projection; for a directional light the length of its depth range
    vec3 right;     // half the map's width, metres, or the half-angle's tangent
    float inner;    // half-angles of a spot light, radians
    vec3 up;        // half the map's height
    float outer;
    vec3 power;     // irradiance W/m^2, or radiant intensity W/sr
    float texel_area; // m^2, or on the plane at distance 1
};

// Layers that fit into 16 KiB of uniforms, with room to spare; Projector::MAX.
const uint MAX_LIGHTS = 64u;

const uint DIRECTIONAL = 0u;
const uint SPOT_BY_ANGLE = 1u;
const uint SPOT_BY_COSINE = 2u;
const uint POINT_FACE = 3u;
// No light's kind, but the value of a shader's constant if its lights are of several kinds.
const uint MIXED = 4u;

// Falloff of a spot light, by the cosine to its axis.
float spot_falloff(Light light, float cosine) {
    if (light.kind == SPOT_BY_ANGLE) {
        float angle = acos(clamp(cosine, -1.0, 1.0));
        return light.outer > light.inner ? clamp((light.outer - angle) / (light.outer - light.inner), 0.0, 1.0) : float(angle <= light.outer);
    }
    if (light.kind == SPOT_BY_COSINE) {
        float width = cos(light.inner) - cos(light.outer);
        float f = width > 0.0 ? clamp((cosine - cos(light.outer)) / width, 0.0, 1.0) : float(cosine >= cos(light.outer));
        return f * f;
    }
    return 1.0;
}

// World position of a point of the map, given by ndc in [-1, 1] with y down, and a depth that is not 0.
EXACT vec3 light_position(Light light, vec2 ndc, float depth) {
    vec3 offset = ndc.x * light.right - ndc.y * light.up;
    if (light.kind == DIRECTIONAL) return light.origin + offset + light.direction * (light.near * (1.0 - depth));
    return light.origin + (light.direction + offset) * (light.near / depth);
}

// Unit normal of the surface at a point of the map, flipped to face the light, from the gradient of depth over ndc. It is exact, since
// depth is linear over a plane's image in both projections.
vec3 light_normal(Light light, vec2 ndc, float depth, vec2 gradient) {
    vec3 along = vec3(gradient * vec2(1.0, -1.0), depth - dot(ndc, gradient));
    // In coordinates along the map's axes: right, up, and the light's direction.
    vec3 n = light.kind == DIRECTIONAL ? vec3(along.xy * light.near, 1.0) : along;
    n = n.x / dot(light.right, light.right) * light.right + n.y / dot(light.up, light.up) * light.up + n.z * light.direction;
    vec3 ray = light.direction;
    if (light.kind != DIRECTIONAL) ray += ndc.x * light.right - ndc.y * light.up;
    return normalize(dot(n, ray) > 0.0 ? -n : n);
}

// Distance along the axis, metres.
float light_distance(Light light, float depth) {
    return light.kind == DIRECTIONAL ? light.near * (1.0 - depth) : light.near / depth;
}

// Solid angle of a texel whose centre is at tangents t on the plane at distance 1.
float texel_solid_angle(float texel_area, vec2 t) {
    float s = 1.0 + dot(t, t);
    return texel_area / (s * sqrt(s));
}

// Flux arriving at a texel of the map, W.
vec3 texel_flux(Light light, vec2 ndc) {
    if (light.kind == DIRECTIONAL) return light.power * light.texel_area;
    vec2 t = ndc * vec2(length(light.right), length(light.up));
    return light.power * spot_falloff(light, inversesqrt(1.0 + dot(t, t))) * texel_solid_angle(light.texel_area, t);
}

// Cross section of a texel's beam at a surface, m^2.
float texel_beam(Light light, vec2 ndc, vec3 position) {
    if (light.kind == DIRECTIONAL) return light.texel_area;
    vec2 t = ndc * vec2(length(light.right), length(light.up));
    vec3 way = position - light.origin;
    return texel_solid_angle(light.texel_area, t) * dot(way, way);
}

// Area of a texel across the map's axis at a surface's distance, m^2 (Bischoff, Schwandt and Broll 2017, equation 1).
float texel_disk(Light light, vec2 ndc, vec3 position) {
    if (light.kind == DIRECTIONAL) return light.texel_area;
    vec2 t = ndc * vec2(length(light.right), length(light.up));
    vec3 way = position - light.origin;
    return light.texel_area * dot(way, way) / (1.0 + dot(t, t));
}

// Unshadowed irradiance of one light on a surface that faces it, W/m^2.
vec3 light_irradiance(Light light, vec3 position, out vec3 to_light) {
    if (light.kind == DIRECTIONAL) {
        to_light = -light.direction;
        return light.power;
    }
    vec3 v = light.origin - position;
    float squared = max(dot(v, v), 1e-12);
    to_light = v * inversesqrt(squared);
    return light.power * spot_falloff(light, dot(-to_light, light.direction)) / squared;
}
#endif
