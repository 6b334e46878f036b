#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// One more path through each pixel, added to each layer. At each surface a path samples one light (next event estimation) and one direction
// to continue in. Light gathered at the k-th surface is direct light for k = 1, and bounce k - 1 after that.
#include "bvh/surface.glsl"
#include "lib/brdf.glsl"
#include "lib/light.glsl"
#include "lib/random.glsl"
#include "lib/sampling.glsl"
#include "lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const bool GLOSSY_DIELECTRIC = false;
layout(constant_id = 1) const uint LIGHT_KIND = 4; // of all lights, or MIXED
layout(constant_id = 2) const bool ENVIRONMENT = true;
layout(constant_id = 3) const bool CENTERED = false; // paths go through pixel centres only

struct Emitter {
    uint triangle;
    uint other;   // its alias in Walker's method
    float share;  // probability of keeping this emitter
};

layout(scalar, push_constant) uniform Params {
    uint first_row;
    uint rows;
    uint sample_index;
    uint seed;
    uint bounces;        // layers of indirect light
    uint lights;
    uint emitters;
    uint emitting_root;  // root node of the tree of emitting triangles
    float emitter_chance; // probability of sampling an emitting surface
    float squared_min_distance; // 0 unless the VPLs' bound is applied
} params;

layout(scalar) uniform ViewBlock { View it; } view;
layout(scalar) uniform LightsBlock { Light at[MAX_LIGHTS]; } lights;
layout(scalar) readonly buffer Emitters { Emitter at[]; } emitters;
layout(rgba32f) uniform image2DArray sums;
layout(scalar) buffer Rays { uint at[]; } rays;

#include "part/sky=reference/sky-constant"

// Layers of the sums: the order of src/reference/sums.rs.
const int RADIANCE = 0;   // alpha: number of paths that hit a surface
const int SPREAD = 1;     // sum of squared differences from the radiance's mean (Welford)
const int IRRADIANCE = 2; // indirect, at first surfaces that reflect diffusely
const int ALBEDO = 3;
const int DIRECT = 4;     // then the bounces

// Sums are kept in two floats, since one loses the last bits of millions of equal numbers. The rounding error of a layer is kept that many
// layers after it as there are layers (Knuth's two-sum).
void add(ivec2 pixel, int layer, vec4 more) {
    ivec3 at = ivec3(pixel, layer), rest_at = ivec3(pixel, layer + DIRECT + int(params.bounces) + 1);
    vec4 before = imageLoad(sums, at);
    precise vec4 after = before + more;
    precise vec4 added = after - before;
    precise vec4 lost = (before - (after - added)) + (more - added);
    imageStore(sums, at, after);
    imageStore(sums, rest_at, imageLoad(sums, rest_at) + lost);
}

// MIS weight of the first of two techniques (power heuristic).
float share(float density, float other) { return density * density / max(density * density + other * other, 1e-30); }

// Density of sample_emitters in the direction by which the path came, 1/sr.
float emitter_density(float density, float distance, float cosine) {
    return params.emitter_chance * density * distance * distance / max(cosine, 1e-9);
}

vec3 reflected(Surface s, vec3 l, vec3 v) {
    if (dot(s.geometric_normal, l) <= 0.0) return vec3(0.0);
    return brdf(s.albedo, s.metallic, s.roughness, GLOSSY_DIELECTRIC, s.normal, l, v) * max(dot(s.normal, l), 0.0);
}

float density(Surface s, vec3 l, vec3 v) { return brdf_density(s.metallic, s.roughness, GLOSSY_DIELECTRIC, s.normal, l, v); }

// One light: half of the samples are in proportion to the lights' unshadowed light on the surface, and half are even among those that shine
// on it, or a sun that is in shadow would take nearly all. Returns its unshadowed contribution, direction and distance.
vec3 sample_lights(Surface s, vec3 v, float u, out vec3 to_light, out float distance) {
    bool evenly = u < 0.5;
    u = evenly ? 2.0 * u : 2.0 * u - 1.0;
    float sum = 0.0, count = 0.0, total = 0.0, chosen_weight = 0.0;
    vec3 chosen = vec3(0.0);
    to_light = s.normal;
    distance = 0.0;
    for (uint i = 0u; i < params.lights; i++) {
        Light light = lights.at[i];
        if (LIGHT_KIND != MIXED) light.kind = LIGHT_KIND;
        vec3 l;
        vec3 arriving = light_irradiance(light, s.position, l);
        float weight = max(dot(s.normal, l), 0.0) * luminance(arriving);
        if (weight > 0.0) {
            sum += weight;
            count += 1.0;
            float own = evenly ? 1.0 : weight;
            total += own;
            float p = own / total;
            if (u < p) {
                u /= p;
                chosen = arriving;
                chosen_weight = weight;
                to_light = l;
                distance = light.kind == DIRECTIONAL ? 1e30 : length(light.origin - s.position);
            } else {
                u = (u - p) / (1.0 - p);
            }
            u = min(u, 0.99999994);
        }
    }
    if (chosen_weight <= 0.0) return vec3(0.0);
    return chosen * reflected(s, to_light, v) / (0.5 * chosen_weight / sum + 0.5 / count);
}

// One point of an emitting surface. Returns its unshadowed contribution, MIS weight included.
vec3 sample_emitters(Surface s, vec3 v, vec3 u, out vec3 to_light, out float distance) {
    to_light = s.normal;
    distance = 0.0;
    float place = u.x * float(params.emitters);
    uint drawn = min(uint(place), params.emitters - 1u);
    Emitter emitter = emitters.at[drawn];
    if (place - float(drawn) >= emitter.share) emitter = emitters.at[emitter.other];
    uint triangle = emitter.triangle;
    uvec4 ta = triangle_texel(3u * triangle), tb = triangle_texel(3u * triangle + 1u), tc = triangle_texel(3u * triangle + 2u);
    float root = sqrt(u.y);
    vec2 weights = vec2(root * (1.0 - u.z), root * u.z);
    vec3 a = uintBitsToFloat(ta.xyz), b = uintBitsToFloat(tb.xyz), c = uintBitsToFloat(tc.xyz);
    vec3 point = (1.0 - weights.x - weights.y) * a + weights.x * b + weights.y * c;
    vec3 way = point - s.position;
    distance = length(way);
    if (distance <= 0.0) return vec3(0.0);
    to_light = way / distance;
    vec3 face = cross(b - a, c - a);
    float cosine = -dot(face, to_light) / length(face);
    if ((tc.w & SINGLE_SIDED) == 0u) cosine = abs(cosine);
    uvec4 ca = corner_texel(3u * triangle), cb = corner_texel(3u * triangle + 1u), cc = corner_texel(3u * triangle + 2u);
    vec2 uv = (1.0 - weights.x - weights.y) * uintBitsToFloat(ca.yz) + weights.x * uintBitsToFloat(cb.yz) + weights.y * uintBitsToFloat(cc.yz);
    float density_of_material = material_numbers(ta.w, 1u).w;
    if (cosine <= 0.0 || density_of_material <= 0.0) return vec3(0.0);
    if (MASKS && (tc.w & MASKED) != 0u && is_hole(tc.w >> MASK_SHIFT, weights)) return vec3(0.0);
    float light_density = emitter_density(density_of_material, distance, cosine);
    return emission_at(ta.w, uv) * reflected(s, to_light, v) / light_density * share(light_density, density(s, to_light, v));
}

void main() {
    // Even rows of workgroups first, then odd rows: a software driver gives each thread a contiguous part, and the top of a picture is
    // seldom as much work as the bottom.
    uint even = (gl_NumWorkGroups.y + 1u) / 2u, turn = gl_WorkGroupID.y;
    uint row = (turn < even ? 2u * turn : 2u * (turn - even) + 1u) * gl_WorkGroupSize.y + gl_LocalInvocationID.y;
    ivec2 pixel = ivec2(gl_GlobalInvocationID.x, params.first_row + row);
    if (row >= params.rows || any(greaterThanEqual(uvec2(pixel), uvec2(view.it.width, view.it.height)))) return;
    uint number = pixel.y * view.it.width + pixel.x;

    // Uniform in the pixel: a box filter.
    vec4 u = random(number, params.sample_index, 0u, params.seed);
    if (CENTERED) u.xy = vec2(0.5);
    vec2 ndc = (vec2(pixel) + u.xy) / vec2(view.it.width, view.it.height) * 2.0 - 1.0;
    Ray ray = make_ray(view.it.position, view.it.forward + ndc.x * view.it.right - ndc.y * view.it.up);
    float t_min = view.it.near;
    vec3 throughput = vec3(1.0), radiance = vec3(0.0), to_irradiance = vec3(0.0), irradiance = vec3(0.0);
    vec3 first_albedo = vec3(0.0);
    float came_with = 0.0; // density of the path's last direction; 0 from the camera
    uint traced = 0u;
    bool met = false;
    // Light gathered at the previous surface, complete once the next ray has found emission or not.
    vec3 gathered = vec3(0.0);
    int gatherer = -1;
    bool goes_on = false; // the path continues beyond the last surface
    for (uint k = 0u; k <= params.bounces; k++) {
        Hit hit = nearest(ray, t_min, k == 0u);
        traced += 1u;
        if (hit.triangle == NO_TRIANGLE) {
            vec3 arriving = sky_radiance(ray.direction);
            if (SKY_SAMPLED && k > 0u) arriving *= share(came_with, sky_density(ray.direction));
            vec3 found = throughput * arriving;
            radiance += found;
            if (ENVIRONMENT && k > 0u) gathered += found;
            if (ENVIRONMENT && k > 1u) irradiance += to_irradiance * arriving;
            break;
        }
        Surface s = surface_at(ray, hit);
        vec3 v = -normalize(ray.direction);
        // A shading normal that faces away, by a normal map or at a grazing angle, is treated as seen at a grazing angle.
        vec3 seen_from = normalize(v + s.normal * max(1e-3 - dot(s.normal, v), 0.0));
        if (EMISSION && any(greaterThan(s.emission, vec3(0.0)))) {
            float mine = 1.0;
            if (k > 0u) mine = share(came_with, emitter_density(s.emitter_density, hit.t, dot(s.geometric_normal, v)));
            vec3 found = throughput * s.emission * mine;
            radiance += found;
            if (k > 0u) gathered += found;
            if (k > 1u) irradiance += to_irradiance * s.emission * mine;
        }
        if (k == 0u) {
            met = true;
            first_albedo = s.albedo;
        }
        if (gatherer >= 0) add(pixel, DIRECT + gatherer, vec4(gathered, 0.0));
        gathered = vec3(0.0);
        gatherer = -1;
        // Light ends at the back of a single-sided surface.
        if (!s.front && !s.double_sided) break;
        if (k > 0u && params.squared_min_distance > 0.0) {
            float bound = min(hit.t * hit.t / params.squared_min_distance, 1.0);
            throughput *= bound;
            to_irradiance *= bound;
        }

        gatherer = int(k);
        vec3 from = off_surface(s.position + s.geometric_normal * (5e-7 * s.reach), s.geometric_normal);
        vec4 choice = random(number, params.sample_index, 2u * k + 1u, params.seed);
        vec3 to_light = s.normal, found = vec3(0.0);
        float distance = 0.0;
        if (EMISSION && choice.w < params.emitter_chance) {
            found = sample_emitters(s, seen_from, choice.xyz, to_light, distance);
        } else if (params.lights > 0u) {
            found = sample_lights(s, seen_from, choice.x, to_light, distance) / (1.0 - params.emitter_chance);
        }
        if (any(greaterThan(found, vec3(0.0)))) {
            traced += 1u;
            // From the lifted origin the direction differs slightly; the end, just before the light, is the same.
            vec3 way = distance < 1e29 ? s.position + to_light * distance - from : to_light;
            if (!is_occluded(make_ray(from, way), distance < 1e29 ? 0.9999 : 1e30)) {
                radiance += throughput * found;
                gathered = throughput * found;
                if (k > 0u) irradiance += to_irradiance * found;
            }
        }

        if (SKY_SAMPLED) {
            vec4 drawn = random(number, params.sample_index, 0x10000u + k, params.seed);
            float sampled_with;
            vec3 arriving = sample_sky(drawn.xy, to_light, sampled_with);
            arriving *= share(sampled_with, density(s, to_light, seen_from));
            vec3 found = arriving * reflected(s, to_light, seen_from);
            if (any(greaterThan(found, vec3(0.0)))) {
                traced += 1u;
                if (!is_occluded(make_ray(from, to_light), 1e30)) {
                    radiance += throughput * found;
                    gathered += throughput * found;
                    if (k > 0u) irradiance += to_irradiance * found;
                }
            }
        }

        if (k == params.bounces && without(either(EMISSION, ENVIRONMENT))) break;
        vec4 next = random(number, params.sample_index, 2u * k + 2u, params.seed);
        vec3 l = sample_brdf(next.xyz, s.metallic, s.roughness, GLOSSY_DIELECTRIC, s.normal, seen_from);
        came_with = density(s, l, seen_from);
        if (came_with <= 0.0 || dot(s.geometric_normal, l) <= 0.0) break;
        vec3 weight = reflected(s, l, seen_from) / came_with;
        if (k == 0u) {
            // Irradiance needs directions only, no BRDF.
            to_irradiance = vec3(s.metallic < 1.0 ? max(dot(s.normal, l), 0.0) / came_with : 0.0);
        } else {
            to_irradiance *= weight;
        }
        throughput *= weight;
        if (k >= 4u) {
            // Russian roulette: paths of low throughput end early, and survivors are weighted up.
            float survives = clamp(max(max(throughput.r, max(throughput.g, throughput.b)), max(to_irradiance.r, max(to_irradiance.g, to_irradiance.b)) / PI), 0.05, 1.0);
            if (next.w >= survives) break;
            throughput /= survives;
            to_irradiance /= survives;
        }
        if (all(equal(throughput, vec3(0.0))) && all(equal(to_irradiance, vec3(0.0)))) break;
        ray = make_ray(from, l);
        t_min = 0.0;
        goes_on = k == params.bounces;
    }

    // Emission seen from the last surface. No light is gathered at further surfaces, so visibility of an emitter is all that the ray needs.
    if (either(EMISSION, ENVIRONMENT)) {
        Hit hit = Hit(1e30, NO_TRIANGLE, vec2(0.0));
        if (EMISSION && goes_on) hit = traverse(ray, params.emitting_root, 0.0, 1e30, false, false);
        vec3 arriving = vec3(0.0);
        if (hit.triangle != NO_TRIANGLE) {
            Shine shine = shine_at(ray, hit);
            arriving = shine.emission * share(came_with, emitter_density(shine.emitter_density, hit.t, shine.cosine));
        } else if (ENVIRONMENT && goes_on) {
            arriving = sky_radiance(ray.direction);
            if (SKY_SAMPLED) arriving *= share(came_with, sky_density(ray.direction));
        }
        if (any(greaterThan(arriving, vec3(0.0)))) {
            traced += 1u;
            if (!is_occluded(ray, hit.t * 0.9999)) {
                radiance += throughput * arriving;
                gathered += throughput * arriving;
                if (params.bounces > 0u) irradiance += to_irradiance * arriving;
            }
        }
    }
    if (gatherer >= 0) add(pixel, DIRECT + gatherer, vec4(gathered, 0.0));

    vec4 before = imageLoad(sums, ivec3(pixel, RADIANCE)), after = before + vec4(radiance, float(met));
    add(pixel, RADIANCE, vec4(radiance, float(met)));
    if (params.sample_index > 0u) {
        vec3 from_old = radiance - before.rgb / float(params.sample_index), from_new = radiance - after.rgb / float(params.sample_index + 1u);
        add(pixel, SPREAD, vec4(from_old * from_new, 0.0));
    }
    if (params.bounces > 0u) add(pixel, IRRADIANCE, vec4(irradiance, 0.0));
    add(pixel, ALBEDO, vec4(first_albedo, 0.0));
    atomicAdd(rays.at[0], traced);
    if (unfinished) atomicOr(rays.at[1], 1u);
}
