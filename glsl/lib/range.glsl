#ifndef RANGE_GLSL
#define RANGE_GLSL
#include "lib/lobe.glsl"
// Bounds of stochastic ranges: spheres and spheroids in view space, whose axes are the camera's right, up and forward (Tokuyoshi and Harada
// 2017, sections 3 to 5).

// A spheroid, stored as the linear map that makes it the unit sphere (BS of equations 16 and 17, with the last row (0, 0, depth)), and the
// image of its centre.
struct Spheroid {
    vec3 row0;
    float depth; // 0 of an empty range
    vec3 row1;
    vec3 centre;
};

// Equation 17: rotates the stretched space so that planes of equal depth stay such planes.
Spheroid spheroid(mat3 s, vec3 centre) {
    vec3 bx = s[0], by = s[1], bz = cross(bx, by);
    vec3 z = normalize(bz), x, y;
    if (dot(bx, bx) > dot(by, by)) {
        x = normalize(bx);
        y = cross(z, x);
    } else {
        y = normalize(by);
        x = cross(y, z);
    }
    Spheroid it;
    it.row0 = x * s;
    it.row1 = y * s;
    it.depth = dot(z, s[2]);
    it.centre = vec3(dot(it.row0, centre), dot(it.row1, centre), it.depth * centre.z);
    return it;
}

// The stretch of equation 16 for a spheroid of half-axes ru along `axis` and r across it.
mat3 stretch(vec3 axis, float ru, float r) { return mat3(1.0 / r) + (1.0 / ru - 1.0 / r) * outerProduct(axis, axis); }

// Square of equation 12's r, of the spheroid that bounds irradiance over delta xi of a lobe.
float squared_lobe_radius(vec3 flux, vec3 f0, float f90, float alpha, float ni, float delta_xi) {
    // Schlick's term is largest for the half vector farthest from the incoming direction: halfway to the surface's far horizon.
    float farthest = cos(0.5 * acos(clamp(ni, 0.0, 1.0)) + 0.25 * PI);
    float g1 = 2.0 * ni / (ni + sqrt((1.0 - alpha * alpha) * ni * ni + alpha * alpha));
    return largest(flux * lobe_fresnel(f0, f90, farthest)) * g1 / (4.0 * PI * delta_xi * ni);
}

// Bounds of a lobe at q: the region where its irradiance on a facing surface is over delta xi (equations 12 to 17).
Spheroid lobe_bounds(vec3 q, vec3 n, vec3 wi, vec3 flux, vec3 f0, float f90, float alpha, float delta_xi) {
    float ni = dot(n, wi), r = sqrt(squared_lobe_radius(flux, f0, f90, alpha, ni, delta_xi)), ru = (1.0 + alpha * alpha) / (2.0 * alpha) * r;
    vec3 mirrored = 2.0 * ni * n - wi;
    return spheroid(stretch(mirrored, ru, r), q + (1.0 - alpha * alpha) / (2.0 * alpha) * r * mirrored);
}

// Bounds of a diffuse VPL: a sphere, as centre and radius. The isosurface is at R sqrt(cos(theta)); the paper's centre, at (1/3)^(1/4) R,
// leaves a part of it out.
vec4 diffuse_bounds(vec3 q, vec3 n, vec3 intensity, float delta_xi) {
    float r = sqrt(largest(intensity) / delta_xi);
    return vec4(q + pow(1.0 / 3.0, 0.75) * r * n, pow(4.0 / 27.0, 0.25) * r);
}
#endif
