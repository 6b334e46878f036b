#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Light caches on their triangles as these are now: an invocation a cache.
#include "lib/light-cache.glsl"
#include "lib/scene.glsl"
#include "lib/vertex.glsl"

layout(local_size_x = 64) in;

layout(scalar, push_constant) uniform Params { uint count; } params;

// A cache of a model: src/scene/caches/mod.rs.
struct ModelCache {
    uvec3 corners;
    uint draw; // among those of its model
    vec2 weights;
    vec3 normal;
    float share;
    float silhouette;
    float opacity;
    uint one_of_two;
};

// A cache of an instance.
struct PlacedCache {
    uint model_cache;
    uint draw;
};

layout(scalar) readonly buffer ModelCaches { ModelCache at[]; } model_caches;
layout(scalar) readonly buffer Placed { PlacedCache at[]; } placed;
layout(scalar) readonly buffer Draws { DrawData at[]; } draws;
layout(scalar) readonly buffer Vertices { Vertex at[]; } vertices;
layout(scalar) readonly buffer Materials { Material at[]; } materials;
layout(scalar) writeonly buffer Caches { LightCache at[]; } caches;

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= params.count) return;
    // A scene without surfaces has one cache, of nothing.
    if (placed.at[i].draw == NO_CACHE) {
        caches.at[i] = LightCache(vec3(0.0), 0.0, vec3(0.0, 0.0, 1.0), 0.0, 0.0, 0.0, 0u);
        return;
    }
    ModelCache it = model_caches.at[placed.at[i].model_cache];
    DrawData draw = draws.at[placed.at[i].draw];
    mat3 world;
    for (uint k = 0u; k < 3u; k++) world[k] = draw.transform * vec4(vertices.at[it.corners[k]].position, 1.0);
    vec3 edge = world[1] - world[0];
    vec3 across = cross(edge, world[2] - world[0]);
    float doubled = length(across);
    // A triangle without area has no frame. Its cache stands for nothing.
    vec3 along = normalize(doubled > 0.0 ? edge : vec3(1.0, 0.0, 0.0));
    vec3 up = doubled > 0.0 ? across / doubled : vec3(0.0, 0.0, 1.0);
    vec3 at = vec3(1.0 - it.weights.x - it.weights.y, it.weights);
    vec3 normal = normalize(it.normal.x * along + it.normal.y * cross(up, along) + it.normal.z * up);
    float exponent = lobe_exponent(materials.at[draw.material].mean_roughness);
    float area = 0.5 * doubled;
    caches.at[i] = LightCache(world * at, area * it.share, normal, exponent, area * it.silhouette, it.opacity, it.one_of_two);
}
