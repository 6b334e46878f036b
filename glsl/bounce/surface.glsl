// Texel of a cluster's map: distance, geometric normal flipped to face the cluster, and albedo (Aranha et al., section III-C).
#include "bounce/map.glsl"
#include "lib/footprint.glsl"
#include "lib/scene.glsl"

layout(constant_id = 1) const bool BASE_COLOR_MAP = false;
layout(constant_id = 2) const bool METALLIC_ROUGHNESS_MAP = false;
layout(constant_id = 4) const bool MASKED = false;
layout(constant_id = 5) const bool VERTEX_COLOR = false;

layout(location = 0) in vec3 in_local;
layout(location = 1) in vec2 in_uv;
layout(location = 2) in vec4 in_color;
layout(location = 3) flat in uint in_cluster;

layout(location = 0) out float distances;
layout(location = 1) out vec2 normal;
layout(location = 2) out vec4 albedo;

layout(scalar, push_constant) uniform Params {
    float far;        // metres
    float texel_size; // in [-1, 1]
    float albedo_lod; // mips: averages the albedo over a VPL's footprint
    uint layer;       // the layer, if layers are drawn one a pass
    uint layers;
} params;

layout(scalar) readonly buffer Clusters { VplCluster at[]; } clusters;
layout(scalar) uniform MaterialBlock { Material it; } material_block;
uniform sampler2DArray base_color_map;
uniform sampler2DArray metallic_roughness_map;

void main() {
    Material material = material_block.it;
    vec4 base = material.base_color;
    if (VERTEX_COLOR) base *= in_color;
    vec3 tint = base.rgb;
    if (BASE_COLOR_MAP) {
        vec3 coordinates = map_coordinates(material.base_color_map, in_uv);
        tint *= mean_over(base_color_map, coordinates, params.albedo_lod).rgb;
        if (MASKED) base.a *= texture(base_color_map, coordinates).a;
    }
    float metallic = material.metallic;
    if (METALLIC_ROUGHNESS_MAP) {
        metallic *= mean_over(metallic_roughness_map, map_coordinates(material.metallic_roughness_map, in_uv), params.albedo_lod).b;
    }

    // Edges bend in this projection, so interpolated positions are off. But they stay in the triangle's plane, whose intersection with the
    // texel's own direction gives the exact distance.
    vec3 along = paraboloid_inverse(gl_FragCoord.xy * params.texel_size - 1.0);
    vec3 n = normalize(cross(dFdx(in_local), dFdy(in_local)));
    float d = length(in_local), exact = dot(n, in_local) / dot(n, along);
    // The interpolated distance is kept for grazing triangles, and for those too small for derivatives.
    if (exact > 0.5 * d && exact < 2.0 * d) d = exact;
    bool turned = dot(n, along) > 0.0;
    if (any(isnan(n))) n = -along;
    mat3 axes = basis_of(octahedral_snorm16_inverse(clusters.at[in_cluster].normal));
    bool lit = gl_FrontFacing || material.double_sided != 0u;
    distances = d / params.far;
    // Depth by the exact distance: the interpolated one would let surfaces just behind a large triangle through.
    gl_FragDepth = 1.0 - distances;
    normal = octahedral(axes * (turned ? -n : n));
    albedo = vec4(lit ? tint * (1.0 - metallic) : vec3(0.0), 1.0);
    if (MASKED && base.a < material.alpha_cutoff) discard;
}
