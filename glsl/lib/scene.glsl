#ifndef SCENE_GLSL
#define SCENE_GLSL
// Draws and materials in the layout of src/world/device.rs.
struct DrawData {
    mat4x3 transform; // columns: axes and translation
    uint material;
    uint double_sided; // of the material
};

// A part of a draw, with its world-space bounding box.
struct PartData {
    vec3 box_min;
    uint draw;
    vec3 box_max;
};

// Texture transform and array layer of a material's map.
struct MapUse {
    mat2 matrix;
    vec2 offset;
    float layer;
};

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
    float mean_roughness; // with its map
    uint padding[23];     // to 256 bytes, so that every device can bind one as a uniform block
};

vec3 map_coordinates(MapUse use, vec2 uv) { return vec3(use.matrix * uv + use.offset, use.layer); }
#endif
