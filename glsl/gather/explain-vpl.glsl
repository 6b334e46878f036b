// Light of VPLs without Russian roulette.
#include "gather/vpl-light.glsl"

void explain(uint index, Receiver r, float visible, inout VplShare share) {
    Vpl it = vpl(index, true);
    vec3 way = it.position - r.position;
    float squared = dot(way, way), from = max(-dot(it.facing, way), 0.0), to = max(dot(r.normal, way), 0.0);
    Pixel p = Pixel(r, vec3(0.0));
    shade(p, it, visible);
    share.light = p.sum;
    share.open = it.intensity * form_factor(it, r.normal, way, squared, from, to);
    share.intensity = it.intensity * (from * inversesqrt(max(squared, 1e-20)));
    share.seen = visible * lit(it.shadow, r.normal, way, squared, from, to);
}
