// Light of virtual area lights at a pixel itself. Light caches sum it elsewhere, so that no VAL has a share in their sum.
#include "gbuffer/receiver.glsl"
#include "lib/pi.glsl"
#include "lib/vpl.glsl"

layout(scalar, push_constant) uniform Params { uint count; } params;

layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;
#include "part/disk=gather/disk-beam"

void explain(uint index, Receiver r, float visible, inout VplShare share) {
    vec3 way = share.position - r.position, intensity = intensities.at[index];
    float squared = max(dot(way, way), 1e-20), from = max(-dot(share.facing, way), 0.0), to = max(dot(r.normal, way), 0.0);
    share.open = intensity * (PI * to * from / (squared * (disk_of(index).x + PI * squared)));
    share.intensity = intensity * (from * inversesqrt(squared));
}
