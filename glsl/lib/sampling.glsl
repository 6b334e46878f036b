// Importance sampling of BRDFs, and densities. Needs lib/brdf.glsl.
#include "lib/basis.glsl"

// Cosine-weighted direction around z.
vec3 sample_cosine(vec2 u) {
    float r = sqrt(u.x), phi = 2.0 * PI * u.y;
    return vec3(r * cos(phi), r * sin(phi), sqrt(max(1.0 - u.x, 0.0)));
}

// Visible GGX microfacet normal for the view direction v, both around z (Dupuy and Benyoub 2023).
vec3 sample_visible_normal(vec2 u, vec3 v, float alpha) {
    vec3 stretched = normalize(vec3(v.xy * alpha, v.z));
    float phi = 2.0 * PI * u.x;
    float z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
    float r = sqrt(clamp(1.0 - z * z, 0.0, 1.0));
    vec3 h = vec3(r * cos(phi), r * sin(phi), z) + stretched;
    return normalize(vec3(h.xy * alpha, max(h.z, 1e-6)));
}

// Density, 1/sr, of v's reflection at such a normal; cosines of half vector and view to the normal.
float visible_normal_density(float nh, float nv, float alpha) {
    float a2 = alpha * alpha;
    float d = nh * nh * (a2 - 1.0) + 1.0;
    // D G1 / (4 nv), with G1 = 2 nv / (nv + sqrt(nv^2 (1 - a2) + a2)).
    return a2 / (PI * d * d) * 0.5 / (nv + sqrt(nv * nv * (1.0 - a2) + a2));
}

// Probability of sampling the glossy lobe.
float glossy_share(float metallic, bool glossy_dielectric) { return glossy_dielectric ? mix(0.5, 1.0, metallic) : metallic; }

// Density, 1/sr, of sample_brdf.
float brdf_density(float metallic, float roughness, bool glossy_dielectric, vec3 n, vec3 l, vec3 v) {
    float nl = dot(n, l);
    if (nl <= 0.0) return 0.0;
    float glossy = glossy_share(metallic, glossy_dielectric);
    float density = (1.0 - glossy) * nl / PI;
    if (glossy > 0.0) {
        float nv = max(dot(n, v), 1e-4), nh = max(dot(n, normalize(l + v)), 0.0);
        density += glossy * visible_normal_density(nh, nv, max(roughness * roughness, 1e-3));
    }
    return density;
}

// Direction sampled from the BRDF's lobes; u.z chooses the lobe. It may lie below the surface, where the density is 0.
vec3 sample_brdf(vec3 u, float metallic, float roughness, bool glossy_dielectric, vec3 n, vec3 v) {
    mat3 frame = basis_of(n);
    vec3 l = frame * sample_cosine(u.xy);
    float glossy = glossy_share(metallic, glossy_dielectric);
    if (glossy > 0.0 && u.z < glossy) {
        vec3 local = v * frame;
        local.z = max(local.z, 1e-4);
        vec3 h = frame * sample_visible_normal(u.xy, normalize(local), max(roughness * roughness, 1e-3));
        l = reflect(-v, h);
    }
    return l;
}
