// Vertex inputs of the clusters' maps.
#include "bounce/map.glsl"
#include "lib/scene.glsl"

layout(constant_id = 5) const bool VERTEX_COLOR = false;

layout(location = 0) in vec3 position;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec4 color;

layout(scalar, push_constant) uniform Params {
    float far;
    float texel_size;
    float albedo_lod;
    uint layer;
    uint layers;
} params;

layout(scalar) readonly buffer Draws { DrawData at[]; } draws;
layout(scalar) readonly buffer Parts { PartData at[]; } parts; // indexed by the first instance
