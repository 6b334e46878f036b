#ifndef PARABOLOID_GLSL
#define PARABOLOID_GLSL
// Paraboloid projection of a hemisphere to the unit disk (Heidrich and Seidel 1998).

// Point of the disk for a unit direction of the hemisphere z >= 0.
vec2 paraboloid(vec3 w) { return w.xy / (1.0 + w.z); }

vec3 paraboloid_inverse(vec2 p) {
    float squared = dot(p, p);
    return vec3(2.0 * p, 1.0 - squared) / (1.0 + squared);
}

// Radius in the unit disk of a disk of world radius r at distance d, at the angle theta to the axis. The thesis leaves the cosine out, as
// this does without `distortion`.
float paraboloid_radius(float r, float d, float cosine, bool distortion) {
    // 2 cos^2(theta / 2) = 1 + cos(theta)
    return r / d * (distortion ? 1.0 / (1.0 + cosine) : 0.5);
}
#endif
