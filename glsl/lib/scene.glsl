#ifndef SCENE_GLSL
#define SCENE_GLSL
// Draws and materials, as src/scene/device.rs fills them.
struct DrawData {
    mat4x3 transform; // columns: axes and translation
    uint material;
    uint vertex_offset; // added to its indices
};

// A vertex as it lies in the vertex buffer.
struct Vertex {
    vec3 position;
    uint normal;  // octahedral_snorm16
    vec2 uv;
    uint color;   // four unsigned normalized bytes
    uint tangent; // see tangent_inverse
};

// Where a material looks a map up.
struct MapUse {
    mat2 matrix;
    vec2 offset;
    float layer;
};

// Where a map's texels lie in the image of all texels, for rays that may meet any material.
struct TexelMap {
    uint first;
    uint size; // width, and height in the upper half; 0 where there is no map
    uint how;  // wrapping across in bits 0 and 1, down in bits 2 and 3; the bits below
};

const uint WRAP_REPEAT = 0u;
const uint WRAP_MIRRORED = 1u;
const uint WRAP_CLAMP = 2u;
const uint NEAREST_TEXEL = 16u;
const uint SRGB_TEXELS = 32u;

struct Material {
    vec4 base_color;
    vec3 emission;
    float metallic;
    float roughness;
    float alpha_cutoff;
    float normal_scale;
    uint double_sided;
    MapUse base_color_map;
    MapUse metallic_roughness_map;
    MapUse emission_map;
    MapUse normal_map;
    TexelMap base_color_texels;
    TexelMap metallic_roughness_texels;
    TexelMap emission_texels;
    TexelMap normal_texels;
    float emitter_density; // 1/m^2: how likely a point of it is when the scene's emitting surfaces are sampled
    uint padding[11]; // to 256 bytes, so that each can be bound as a uniform block
};

vec3 map_coordinates(MapUse use, vec2 uv) { return vec3(use.matrix * uv + use.offset, use.layer); }
#endif
