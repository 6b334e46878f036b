#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// VPLs of the next bounce: samples of the clusters' maps, over the unit disk or, as a rival, the square around it (Aranha et al., section
// III-C). A cluster emits its flux with a cosine lobe. A sample represents its share of the disk's area, times 4 / (1 + r^2)^2 for solid
// angle.
#include "bounce/map.glsl"
#include "lib/hammersley.glsl"
#include "lib/permutation.glsl"
#include "lib/pi.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool DISK = true;

layout(scalar, push_constant) uniform Params {
    uint count;    // VPLs
    int size;      // of a map
    float far;     // metres
    vec2 shift;    // rotation of the point set modulo 1
} params;

layout(scalar) readonly buffer Clusters { VplCluster at[]; } clusters;
layout(scalar) readonly buffer Starts { uint at[]; } starts; // first VPL of each cluster, and the number of VPLs last
uniform sampler2DArray distances;
uniform sampler2DArray normals;
uniform sampler2DArray albedos;
layout(scalar) writeonly buffer Places { VplPlace at[]; } places;
layout(scalar) writeonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) writeonly buffer Areas { float at[]; } areas;
layout(scalar) buffer Wasted { uint count; } wasted; // samples outside of the disk
layout(scalar) buffer Lit { uint count; } lit;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    // Permuted, so that every sample set of the pixels gets VPLs of every cluster.
    uint sample_index = permutation(index, params.count);
    uint number = 0u;
    while (starts.at[number + 1u] <= sample_index) number++;
    uint count = starts.at[number + 1u] - starts.at[number];
    vec2 u = fract(hammersley(sample_index - starts.at[number], count) + params.shift);
    vec2 p = 2.0 * u - 1.0;
    float area = 4.0 / float(count);
    if (DISK) {
        p = sqrt(u.x) * vec2(cos(2.0 * PI * u.y), sin(2.0 * PI * u.y));
        area = PI / float(count);
    }

    VplPlace place = VplPlace(vec3(0.0), 0u);
    vec3 intensity = vec3(0.0);
    float beam = 0.0;
    float squared = dot(p, p);
    if (squared >= 1.0) {
        atomicAdd(wasted.count, 1u);
    } else {
        VplCluster cluster = clusters.at[number];
        ivec3 texel = ivec3(clamp(ivec2((p * 0.5 + 0.5) * float(params.size)), ivec2(0), ivec2(params.size - 1)), number);
        float d = texelFetch(distances, texel, 0).r;
        if (d < 1.0 && cluster.members > 0u) {
            mat3 axes = basis_of(octahedral_snorm16_inverse(cluster.normal));
            vec3 along = axes * paraboloid_inverse((vec2(texel.xy) + 0.5) * (2.0 / float(params.size)) - 1.0);
            d *= params.far;
            place.position = cluster.position + along * d;
            place.normal = octahedral_snorm16(octahedral_inverse(texelFetch(normals, texel, 0).xy));
            float cosine = (1.0 - squared) / (1.0 + squared), solid_angle = 4.0 * area / ((1.0 + squared) * (1.0 + squared));
            intensity = cluster.flux * (cosine * solid_angle / PI) * texelFetch(albedos, texel, 0).rgb / PI;
            // Footprint of the beam, widened by the spread of the cluster's VPLs.
            beam = solid_angle * (d * d + cluster.spread);
        }
    }
    places.at[index] = place;
    intensities.at[index] = intensity;
    areas.at[index] = any(greaterThan(intensity, vec3(0.0))) ? beam : 0.0;
    if (any(greaterThan(intensity, vec3(0.0)))) atomicAdd(lit.count, 1u);
}
