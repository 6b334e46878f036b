// Importance of texels to the view (Barak et al. 2013, equations 1 and 2): the light that a texel, as a virtual point light, would have
// the view samples reflect to the camera, without shadows. It is worked out by these instructions in this order wherever it is needed, so that a map of
// all texels and single texels agree to the last bit.
#define EXACT precise
#include "lib/brdf.glsl"
#include "part/gloss=vpls/gloss-none"
#include "vpls/at-once.glsl"
#include "vpls/candidate.glsl"
#include "vpls/view-sample.glsl"

layout(constant_id = 1) const bool GLOSSY_RECEIVERS = false;  // GGX at the view samples
layout(constant_id = 2) const bool GLOSSY_DIELECTRIC = false;
layout(constant_id = 3) const bool DIFFUSE_VPLS = true;

layout(scalar) uniform ViewImportanceBlock {
    uint samples;
    float squared_min_distance;
} view_importance;
#include "part/samples=vpls/samples-uniform"
#include "part/floor=vpls/floor-none"

// Power of a candidate, up to a factor.
EXACT float power_of(Candidate from) { return (DIFFUSE_VPLS ? from.brightness : 0.0) + gloss_power(from.gloss); }

// Light that a view sample reflects. As in the gather, a distance bounds the singularity.
EXACT float reflected(Candidate from, ViewSample to, ViewSampleLobe lobe) {
    vec3 way = to.position - from.position;
    float squared = exact_dot(way, way), leaves = max(exact_dot(from.normal, way), 0.0), arrives = max(-exact_dot(to.normal, way), 0.0);
    float intensity = DIFFUSE_VPLS ? from.brightness * leaves : 0.0;
    float reflectance = max(to.albedo, 0.0);
    precise vec3 direction = way * inversesqrt(max(squared, 1e-20));
    if (has_gloss() && leaves > 0.0) intensity += gloss_towards(from.gloss, direction) * sqrt(squared);
    if (GLOSSY_RECEIVERS && arrives > 0.0 && to.albedo >= 0.0) {
        reflectance = brdf(vec3(to.albedo), lobe.metallic, lobe.roughness, GLOSSY_DIELECTRIC, to.normal, -direction, lobe.to_viewer).x * PI;
    }
    return intensity * arrives / max(squared * max(squared, view_importance.squared_min_distance), 1e-20) * reflectance;
}

void importances(ivec3 at[AT_ONCE], uvec2 size, out float found[AT_ONCE]) {
    Candidate candidates[AT_ONCE];
    for (uint k = 0u; k < AT_ONCE; k++) candidates[k] = candidate(at[k], size);
    precise float sums[AT_ONCE];
    for (uint k = 0u; k < AT_ONCE; k++) sums[k] = 0.0;
    // Two samples a turn: a candidate is read once for both. After an odd number of them there is one without a surface.
    for (uint i = 0u; i < view_importance.samples; i += 2u) {
        ViewSample first = sample_at(i), second = sample_at(i + 1u);
        ViewSampleLobe first_lobe = NO_LOBE, second_lobe = NO_LOBE;
        if (GLOSSY_RECEIVERS) {
            first_lobe = lobe_at(i);
            second_lobe = lobe_at(i + 1u);
        }
        for (uint k = 0u; k < AT_ONCE; k++) {
            sums[k] += reflected(candidates[k], first, first_lobe);
            sums[k] += reflected(candidates[k], second, second_lobe);
        }
    }
    for (uint k = 0u; k < AT_ONCE; k++) {
        sums[k] += power_of(candidates[k]) * least_importance();
        found[k] = sums[k];
    }
}
