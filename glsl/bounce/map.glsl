// Projection of a VPL cluster's map: paraboloid (Heidrich and Seidel 1998), centred on the normal.
#include "bounce/vpl-cluster.glsl"
#include "bounce/limits.glsl"
#include "lib/basis.glsl"
#include "lib/packing.glsl"
#include "lib/paraboloid.glsl"

// A world position in a cluster's space: across, up, along the normal.
vec3 map_space(VplCluster cluster, vec3 world) {
    return (world - cluster.position) * basis_of(octahedral_snorm16_inverse(cluster.normal));
}

// Clip position: w is the projection's divisor, so that edges run straight between their corners' projections, however far behind the
// cluster one corner lies. The depth falls with the distance.
vec4 map_clip(vec3 local, float far) {
    float d = length(local), w = d + local.z;
    return vec4(local.xy, (1.0 - d / far) * w, w);
}
