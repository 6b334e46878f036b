// A VPL's light at a pixel, by chance (Tokuyoshi and Harada 2017, section 3): what tiles, splats and clusters of stochastic light culling
// share. Whoever includes it defines Shadow and what gather/per-pixel.glsl asks for of it, and
//     float reflect_from(inout Receiver r, vec3 light, vec3 to_light);
// what a receiver's own gloss makes of irradiance that comes from a direction, and the share that it leaves.
#include "lib/lobe.glsl"
#include "lib/color.glsl"
#include "lib/packing.glsl"
#include "lib/view.glsl"
#include "lib/vpl.glsl"

layout(constant_id = 0) const uint INTERLEAVE = 1;
layout(constant_id = 9) const bool COATED = false; // VPLs lie on glossy dielectrics: what the gloss reflects is not the diffuse VPL's

layout(scalar, push_constant) uniform Params {
    uint count;
    float squared_min_distance;
    float delta;
} params;

layout(scalar) uniform ViewBlock { View it; } view;
uniform sampler2D depth;
uniform sampler2D normal;
layout(scalar) readonly buffer Points { VplPoint at[]; } points;
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) readonly buffer Lobes { Lobe at[]; } lobes;
layout(scalar) readonly buffer Chances { vec2 at[]; } chances;

Shadow shadow_of(uint vpl, vec3 position, vec3 facing);
float lit(Shadow shadow, vec3 normal, vec3 way, float squared, float from, float to);

struct Receiver {
    ivec2 pixel;
    vec3 position;
    vec3 normal;
    vec3 sum;
    vec3 reflected; // radiance to the eye, beside what the diffuse part makes of the sum
    float distance; // along the view's axis; 0 where there is no surface
    bool far;       // in the farther half
    uvec4 numbers;  // for the statistics
};

Receiver receiver(ivec2 pixel) {
    Receiver r = Receiver(pixel, vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 0.0, false, uvec4(0u));
    if (all(lessThan(uvec2(pixel), uvec2(view.it.width, view.it.height)))) {
        float z = texelFetch(depth, pixel, 0).r;
        if (z > 0.0) {
            r.position = view_position(view.it, pixel, z);
            r.normal = octahedral_inverse(texelFetch(normal, pixel, 0).xy);
            r.distance = view.it.near / z;
        }
    }
    return r;
}

float reflect_from(inout Receiver r, vec3 light, vec3 to_light);

// Equations 2 and 3: what a VPL adds, from its irradiance on a surface that faces it.
vec3 by_chance(vec3 facing_irradiance, float xi, inout uint number) {
    float most = largest(facing_irradiance);
    if (!(most > params.delta * xi)) return vec3(0.0);
    number++;
    return facing_irradiance * max(params.delta / most, 1.0);
}

void add(inout Receiver r, vec3 arrives, vec3 way, float squared, float inverse, float from, float to, Shadow shadow, float visible) {
    if (largest(arrives) <= 0.0 || to <= 0.0) return;
    vec3 light = arrives * (to * inverse * visible * lit(shadow, r.normal, way, squared, from, to));
    r.sum += light * reflect_from(r, light, way * inverse);
}

void shade_diffuse(inout Receiver r, vec3 position, vec3 facing, vec3 intensity, vec3 incoming, float xi, Shadow shadow, float visible) {
    vec3 way = position - r.position;
    float squared = dot(way, way), inverse = inversesqrt(max(squared, 1e-20));
    float from = max(-dot(facing, way), 0.0), to = max(dot(r.normal, way), 0.0);
    vec3 arrives = by_chance(intensity * (from * inverse / max(max(squared, params.squared_min_distance), 1e-20)), xi, r.numbers.y);
    if (COATED && largest(arrives) > 0.0) arrives *= 1.0 - coat_fresnel(dot(incoming, normalize(incoming - way * inverse)));
    add(r, arrives, way, squared, inverse, from, to, shadow, visible);
}

void shade_lobe(inout Receiver r, vec3 position, vec3 facing, Lobe lobe, vec3 n, vec3 wi, float xi, Shadow shadow, float visible) {
    vec3 way = position - r.position;
    float squared = dot(way, way), inverse = inversesqrt(max(squared, 1e-20));
    float from = -dot(facing, way), to = max(dot(r.normal, way), 0.0);
    if (from <= 0.0) return;
    vec3 intensity = lobe_intensity(lobe.flux, lobe.f0, lobe.f90, lobe.alpha, n, wi, way * -inverse);
    vec3 arrives = by_chance(intensity / max(max(squared, params.squared_min_distance), 1e-20), xi, r.numbers.w);
    add(r, arrives, way, squared, inverse, from, to, shadow, visible);
}

// VPL number `index` as a diffuse one, ready to shine.
struct Diffuse {
    vec3 position;
    vec3 facing;
    vec3 intensity;
    vec3 incoming; // where its light comes from, if it is coated
    float xi;
    Shadow shadow;
};

Diffuse diffuse_vpl(uint index) {
    VplPoint point = points.at[index];
    vec3 facing = octahedral_snorm16_inverse(point.normal);
    vec3 incoming = vec3(0.0);
    if (COATED) incoming = octahedral_snorm16_inverse(lobes.at[index].incoming);
    return Diffuse(point.position, facing, intensities.at[index], incoming, chances.at[index].x, shadow_of(index, point.position, facing));
}

void shade(inout Receiver r, Diffuse it, float visible) {
    shade_diffuse(r, it.position, it.facing, it.intensity, it.incoming, it.xi, it.shadow, visible);
}

// And as a glossy one.
struct Glossy {
    vec3 position;
    vec3 facing;
    Lobe lobe;
    vec3 normal;
    vec3 incoming;
    float xi;
    Shadow shadow;
};

Glossy glossy_vpl(uint index) {
    VplPoint point = points.at[index];
    Lobe lobe = lobes.at[index];
    vec3 facing = octahedral_snorm16_inverse(point.normal);
    return Glossy(point.position, facing, lobe, octahedral_snorm16_inverse(lobe.normal), octahedral_snorm16_inverse(lobe.incoming),
                  chances.at[index].y, shadow_of(index, point.position, facing));
}

void shade(inout Receiver r, Glossy it, float visible) {
    shade_lobe(r, it.position, it.facing, it.lobe, it.normal, it.incoming, it.xi, it.shadow, visible);
}
