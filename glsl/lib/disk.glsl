#ifndef DISK_GLSL
#define DISK_GLSL
// Irradiance, in 1/m^2 times the intensity, at a point from a disk whose radiant intensity along its normal `facing` is 1, and whose
// radiance is the same in all directions. `way` leads to its centre. Points in the disk's plane, or behind it, get none.
//
// The result is exact if all of the disk lies well above the receiver's horizon: the configuration factors from an element to a disk,
// parallel and perpendicular (see catalogues), are the components of one vector. A disk that the horizon cuts, such as one near the foot of
// a wall, lights the wall with all of its flux from the part above: it represents surface in front of the wall, and there is none behind
// it. On curved surfaces, such as a column, this leaves an edge where the centre sets.
float disk_light(vec3 way, vec3 facing, float squared_radius, vec3 normal) {
    float height = -dot(facing, way), to = dot(normal, way);
    if (height <= 0.0 || to <= 0.0) return 0.0;
    vec3 across = way + facing * height;
    float aa = dot(across, across), hh = height * height;
    float sum = aa + hh + squared_radius, rest = aa - hh - squared_radius;
    float root = sqrt(rest * rest + 4.0 * aa * hh);
    // root - rest, written without cancellation far from the axis.
    float less = rest > 0.0 ? 4.0 * aa * hh / (root + rest) : root - rest;
    vec3 flow = (2.0 * height * across - less * facing) / max(root * (root + sum), 1e-30);
    float strength = length(flow);
    // At the horizon, a sphere of the same apparent size approximates the disk.
    float cosine = dot(flow, normal) / max(strength, 1e-30), sine = sqrt(min(strength * squared_radius, 1.0));
    float above = max(cosine, -sine) + sine;
    float shown = cosine >= sine ? cosine : above * above / max(4.0 * sine, 1e-30);
    // The disk's extent along the receiver's normal, and about the share of its area above the horizon.
    float tilt = dot(facing, normal);
    float cut = min(to / max(sqrt(squared_radius * max(1.0 - tilt * tilt, 0.0)), 1e-30), 1.0);
    float before = 0.5 + 0.5 * cut * (1.27 - 0.27 * cut * cut);
    return strength * shown / before;
}
#endif
