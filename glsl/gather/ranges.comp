#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Stochastic range of each VPL in this frame, by one random number a VPL; the expected light is unchanged (Tokuyoshi and Harada 2017,
// sections 3 and 4).
#include "lib/lobe.glsl"
#include "lib/range.glsl"
#include "lib/packing.glsl"
#include "lib/random.glsl"
#include "lib/view.glsl"
#include "lib/vpl.glsl"

layout(local_size_x = 64) in;
layout(constant_id = 0) const bool LOBES = false;
layout(constant_id = 2) const bool CLAMPED = false;
layout(constant_id = 1) const uint BOUNDS = 0u; // of lobes: the spheroid, a sphere around it, or a sphere around the VPL

layout(scalar, push_constant) uniform Params {
    uint count;
    float delta; // irradiance of a facing surface below which Russian roulette decides, W/m^2
    uint seed;
} params;

layout(scalar) uniform ViewBlock { View it; } view;
layout(scalar) readonly buffer Places { VplPlace at[]; } places;
layout(scalar) readonly buffer Intensities { vec3 at[]; } intensities;
layout(scalar) readonly buffer Lobes { Lobe at[]; } lobes;
layout(scalar) writeonly buffer Spheres { vec4 at[]; } spheres; // centre in view space, and radius; 0 if nothing is lit
layout(scalar) writeonly buffer Spheroids { Spheroid at[]; } spheroids;
layout(scalar) writeonly buffer Chances { vec2 at[]; } chances; // xi of the diffuse VPL and of the lobe, in (0, 1)

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    // Without roulette, light below delta is cut off: biased, but without noise.
    vec2 xi = CLAMPED ? vec2(0.999999) : (vec2(pcg4d(uvec4(index, 7u, 0u, params.seed)).xy >> 9u) + 0.5) / 8388608.0;
    chances.at[index] = xi;

    VplPlace place = places.at[index];
    mat3 to_view = transpose(mat3(normalize(view.it.right), normalize(view.it.up), view.it.forward));
    vec3 q = to_view * (place.position - view.it.position);
    vec3 facing = to_view * octahedral_snorm16_inverse(place.normal);
    spheres.at[index] = diffuse_bounds(q, facing, intensities.at[index], params.delta * xi.x);

    if (LOBES) {
        Lobe lobe = lobes.at[index];
        Spheroid bound = Spheroid(vec3(0.0), 0.0, vec3(0.0), vec3(0.0));
        vec3 n = to_view * octahedral_snorm16_inverse(lobe.normal), wi = to_view * octahedral_snorm16_inverse(lobe.incoming);
        float ni = dot(n, wi);
        if (largest(lobe.flux) > 0.0 && ni > 0.0) {
            float radius = sqrt(squared_lobe_radius(lobe.flux, lobe.f0, lobe.f90, lobe.alpha, ni, params.delta * xi.y));
            float alpha = lobe.alpha, ru = (1.0 + alpha * alpha) / (2.0 * alpha) * radius;
            vec3 mirrored = 2.0 * ni * n - wi;
            vec3 centre = q + (1.0 - alpha * alpha) / (2.0 * alpha) * radius * mirrored;
            if (BOUNDS == 1u) bound = spheroid(mat3(1.0 / ru), centre);
            else if (BOUNDS == 2u) bound = spheroid(mat3(alpha / radius), q);
            else bound = lobe_bounds(q, n, wi, lobe.flux, lobe.f0, lobe.f90, lobe.alpha, params.delta * xi.y);
        }
        spheroids.at[index] = bound;
    }
}
