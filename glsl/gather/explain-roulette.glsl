// Light of diffuse and glossy VPLs by Russian roulette.
#include "part/shadow=gather/shadow-none"
#include "gather/stochastic.glsl"
#include "gather/reflection-ggx.glsl"

layout(constant_id = 3) const bool DIFFUSE = true;
layout(constant_id = 4) const bool LOBES = false;

void explain(uint index, Receiver r, float visible, inout VplShare share) {
    vec3 way = places.at[index].position - r.position, facing = share.facing;
    float squared = dot(way, way), inverse = inversesqrt(max(squared, 1e-20));
    float from = max(-dot(facing, way), 0.0), to = max(dot(r.normal, way), 0.0);
    Pixel p = Pixel(r, vec3(0.0), vec3(0.0), false, uvec4(0u));
    // Irradiance on a surface that faces the VPL, before roulette.
    vec3 arrives = vec3(0.0);
    if (DIFFUSE) {
        Diffuse it = diffuse_vpl(index);
        shade(p, it, visible);
        arrives = diffuse_irradiance(it.intensity, from, squared, inverse);
        if (COATED && largest(arrives) > 0.0) arrives *= left_by_coat(it.incoming, -way * inverse);
    }
    if (LOBES) {
        Glossy it = glossy_vpl(index);
        shade(p, it, visible);
        if (from > 0.0) arrives += lobe_irradiance(it.lobe, it.normal, it.incoming, way, squared, inverse);
    }
    share.light = p.sum;
    share.reflected = p.reflected;
    share.intensity = arrives * max(max(squared, params.squared_min_distance), 1e-20);
    share.seen = visible * lit(shadow_of(index, places.at[index].position, facing), r.normal, way, squared, from, to);
    Pixel unshadowed = Pixel(r, vec3(0.0), vec3(0.0), false, uvec4(0u));
    share.open = arrives * (to * inverse);
    share.open *= reflect_from(unshadowed, share.open, way * inverse);
}
