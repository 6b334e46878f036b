// Importance of texels to the view (Barak et al. 2013, equations 1 and 2): the light that a texel, as a virtual point light, would have
// the view samples reflect to the camera, without shadows. It is worked out by these instructions in this order wherever it is needed,
// whatever the subgroup's size, so that a map of all texels and single texels agree; in the last bit too, unless a compiler contracts what
// `precise` does not reach.
#include "lib/brdf.glsl"
#include "part/gloss=vpls/gloss-none"
#include "vpls/candidate.glsl"
#include "vpls/view-sample.glsl"

layout(constant_id = 1) const bool GLOSSY_RECEIVERS = false;  // GGX at the view samples
layout(constant_id = 2) const bool GLOSSY_DIELECTRIC = false;
layout(constant_id = 3) const bool DIFFUSE_VPLS = true;

layout(scalar) uniform ViewImportanceBlock {
    uint samples;
    float squared_min_distance;
} view_importance;
layout(scalar) readonly buffer ViewSamples { ViewSample at[]; } view_samples;
#include "part/floor=vpls/floor-none"

// Power of a candidate, up to a factor.
float power_of(Candidate from) { return (DIFFUSE_VPLS ? from.brightness : 0.0) + gloss_power(from.gloss); }

ViewSample hand_round(ViewSample mine, uint lane) {
    ViewSample it = mine;
    it.position = subgroupBroadcast(mine.position, lane);
    it.albedo = subgroupBroadcast(mine.albedo, lane);
    it.normal = subgroupBroadcast(mine.normal, lane);
    if (GLOSSY_RECEIVERS) {
        it.metallic = subgroupBroadcast(mine.metallic, lane);
        it.to_viewer = subgroupBroadcast(mine.to_viewer, lane);
        it.roughness = subgroupBroadcast(mine.roughness, lane);
    }
    return it;
}

// Light that a view sample reflects. As in the gather, a distance bounds the singularity.
float reflected(Candidate from, ViewSample to) {
    precise vec3 way = to.position - from.position;
    precise float squared = dot(way, way), leaves = max(dot(from.normal, way), 0.0), arrives = max(-dot(to.normal, way), 0.0);
    precise float intensity = DIFFUSE_VPLS ? from.brightness * leaves : 0.0;
    precise float reflectance = max(to.albedo, 0.0);
    if (has_gloss() && leaves > 0.0) intensity += gloss_towards(from.gloss, way * inversesqrt(max(squared, 1e-20))) * sqrt(squared);
    if (GLOSSY_RECEIVERS && arrives > 0.0 && to.albedo >= 0.0) {
        vec3 light = way * -inversesqrt(max(squared, 1e-20));
        reflectance = brdf(vec3(to.albedo), to.metallic, to.roughness, GLOSSY_DIELECTRIC, to.normal, light, to.to_viewer).x * PI;
    }
    precise float light = intensity * arrives / max(squared * max(squared, view_importance.squared_min_distance), 1e-20) * reflectance;
    return light;
}

vec4 importances(ivec3 a, ivec3 b, ivec3 c, ivec3 d, uvec2 size) {
    Candidate at[4] = Candidate[4](candidate(a, size), candidate(b, size), candidate(c, size), candidate(d, size));
    // Each lane of a subgroup fetches a view sample and broadcasts it. All lanes sum all samples in the same order.
    precise vec4 sum = vec4(0.0);
    uint count = view_importance.samples, lanes = min(gl_SubgroupSize, 32u);
    for (uint start = 0u; start < count; start += lanes) {
        uint mine = start + gl_SubgroupInvocationID;
        ViewSample fetched = view_samples.at[min(mine, count - 1u)];
        // A sample without a surface reflects nothing, so that the last round needs no end of its own.
        if (mine >= count) fetched.albedo = -1.0;
        // A metal's diffuse albedo is 0.
        fetched.albedo *= GLOSSY_RECEIVERS ? 1.0 : 1.0 - fetched.metallic;
        for (uint lane = 0u; lane < lanes; lane++) {
            ViewSample it = hand_round(fetched, lane);
            sum += vec4(reflected(at[0], it), reflected(at[1], it), reflected(at[2], it), reflected(at[3], it));
        }
    }
    vec4 power = vec4(power_of(at[0]), power_of(at[1]), power_of(at[2]), power_of(at[3]));
    precise vec4 importance = sum + power * least_importance();
    return importance;
}
