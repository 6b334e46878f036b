// Light of a VPL at a pixel by Russian roulette (Tokuyoshi and Harada 2017, section 3): shared by tiles, splats and froxels of stochastic
// light culling. An includer has a part for "shadow", and includes one of gather/reflection-*.glsl, which define
//     float reflect_from(inout Pixel p, vec3 light, vec3 to_light);
// It adds the receiver's glossy reflection of irradiance from a direction, and returns the share that remains for diffuse reflection.
#include "gbuffer/receiver.glsl"
#include "lib/lobe.glsl"
#include "lib/color.glsl"
#include "lib/interleave.glsl"
#include "lib/packing.glsl"
#include "lib/vpl.glsl"

layout(constant_id = 9) const bool COATED = false; // a glossy coat takes its Fresnel share out of diffuse VPLs

layout(scalar, push_constant) uniform Params {
    uint count;
    float squared_min_distance;
    float delta;
} params;

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) readonly buffer Lobes { Lobe at[]; } lobes;
layout(scalar) readonly buffer Chances { vec2 at[]; } chances;

struct Pixel {
    Receiver at;
    vec3 sum;       // irradiance of the VPLs so far, W/m^2
    vec3 reflected; // glossily reflected radiance to the eye
    bool far;       // in the farther half
    uvec4 numbers;  // for the statistics
};

Pixel pixel_at(ivec2 place) { return Pixel(receiver(place), vec3(0.0), vec3(0.0), false, uvec4(0u)); }

float reflect_from(inout Pixel p, vec3 light, vec3 to_light);

// Equations 2 and 3: a VPL's contribution after roulette, from its irradiance on a facing surface.
vec3 by_chance(vec3 facing_irradiance, float xi, inout uint number) {
    float most = largest(facing_irradiance);
    if (!(most > params.delta * xi)) return vec3(0.0);
    number++;
    return facing_irradiance * max(params.delta / most, 1.0);
}

void add(inout Pixel p, vec3 arrives, vec3 way, float squared, float inverse, float from, float to, Shadow shadow, float visible) {
    if (largest(arrives) <= 0.0 || to <= 0.0) return;
    vec3 light = arrives * (to * inverse * visible * lit(shadow, p.at.normal, way, squared, from, to));
    p.sum += light * reflect_from(p, light, way * inverse);
}

// Irradiance of a diffuse VPL on a surface that faces it, unshadowed and before roulette.
vec3 diffuse_irradiance(vec3 intensity, float from, float squared, float inverse) {
    return intensity * (from * inverse / max(max(squared, params.squared_min_distance), 1e-20));
}

// Share of a diffuse VPL's light that its glossy coat leaves; `out_going` is a unit vector.
float left_by_coat(vec3 incoming, vec3 out_going) { return 1.0 - coat_fresnel(dot(incoming, normalize(incoming + out_going))); }

void shade_diffuse(inout Pixel p, vec3 position, vec3 facing, vec3 intensity, vec3 incoming, float xi, Shadow shadow, float visible) {
    vec3 way = position - p.at.position;
    float squared = dot(way, way), inverse = inversesqrt(max(squared, 1e-20));
    float from = max(-dot(facing, way), 0.0), to = max(dot(p.at.normal, way), 0.0);
    vec3 arrives = by_chance(diffuse_irradiance(intensity, from, squared, inverse), xi, p.numbers.y);
    if (COATED && largest(arrives) > 0.0) arrives *= left_by_coat(incoming, -way * inverse);
    add(p, arrives, way, squared, inverse, from, to, shadow, visible);
}

// Irradiance of a glossy VPL on a surface that faces it, unshadowed and before roulette.
vec3 lobe_irradiance(Lobe lobe, vec3 n, vec3 wi, vec3 way, float squared, float inverse) {
    return lobe_intensity(lobe.flux, lobe.f0, lobe.f90, lobe.alpha, n, wi, way * -inverse) /
           max(max(squared, params.squared_min_distance), 1e-20);
}

void shade_lobe(inout Pixel p, vec3 position, vec3 facing, Lobe lobe, vec3 n, vec3 wi, float xi, Shadow shadow, float visible) {
    vec3 way = position - p.at.position;
    float squared = dot(way, way), inverse = inversesqrt(max(squared, 1e-20));
    float from = -dot(facing, way), to = max(dot(p.at.normal, way), 0.0);
    if (from <= 0.0) return;
    vec3 arrives = by_chance(lobe_irradiance(lobe, n, wi, way, squared, inverse), xi, p.numbers.w);
    add(p, arrives, way, squared, inverse, from, to, shadow, visible);
}

// A diffuse VPL, unpacked.
struct Diffuse {
    vec3 position;
    vec3 facing;
    vec3 intensity;
    vec3 incoming; // direction of incident light, if it is coated
    float xi;
    Shadow shadow;
};

Diffuse diffuse_vpl(uint index) {
    VplPlace place = places.at[index];
    vec3 facing = octahedral_snorm16_inverse(place.normal);
    vec3 incoming = vec3(0.0);
    if (COATED) incoming = octahedral_snorm16_inverse(lobes.at[index].incoming);
    return Diffuse(place.position, facing, intensities.at[index], incoming, chances.at[index].x, shadow_of(index, place.position, facing));
}

void shade(inout Pixel p, Diffuse it, float visible) {
    shade_diffuse(p, it.position, it.facing, it.intensity, it.incoming, it.xi, it.shadow, visible);
}

// A glossy VPL, unpacked.
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
    VplPlace place = places.at[index];
    Lobe lobe = lobes.at[index];
    vec3 facing = octahedral_snorm16_inverse(place.normal);
    return Glossy(place.position, facing, lobe, octahedral_snorm16_inverse(lobe.normal), octahedral_snorm16_inverse(lobe.incoming),
                  chances.at[index].y, shadow_of(index, place.position, facing));
}

void shade(inout Pixel p, Glossy it, float visible) {
    shade_lobe(p, it.position, it.facing, it.lobe, it.normal, it.incoming, it.xi, it.shadow, visible);
}
