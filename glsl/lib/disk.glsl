#ifndef DISK_GLSL
#define DISK_GLSL
// How brightly a disk of radiant intensity 1 along its normal `facing`, the same radiance to all sides, lights a point from which its centre
// lies along `way`, 1/m^2. A point of the disk's own plane, or behind it, gets nothing.
//
// Where all of the disk lies well before the receiver's plane this is exact: the configuration factors of an element and a disk, parallel and
// perpendicular (as catalogues of them have it), which are the two sides of one vector. Where the plane cuts the disk, as
// that of a wall does whose foot a lamp of the floor is near, the part before it shines with all of the light: it stands for surface that is
// there, and what would lie behind the wall is not.
// On a surface that bends, such as a column's, this leaves an edge where the centre sets.
float disk_light(vec3 way, vec3 facing, float squared_radius, vec3 normal) {
    float height = -dot(facing, way), to = dot(normal, way);
    if (height <= 0.0 || to <= 0.0) return 0.0;
    vec3 across = way + facing * height;
    float aa = dot(across, across), hh = height * height;
    float sum = aa + hh + squared_radius, rest = aa - hh - squared_radius;
    float root = sqrt(rest * rest + 4.0 * aa * hh);
    // root - rest, which cancels far out beside the axis.
    float less = rest > 0.0 ? 4.0 * aa * hh / (root + rest) : root - rest;
    vec3 flow = (2.0 * height * across - less * facing) / max(root * (root + sum), 1e-30);
    float strength = length(flow);
    // A sphere that looks as large stands for the disk where the horizon cuts it.
    float cosine = dot(flow, normal) / max(strength, 1e-30), sine = sqrt(min(strength * squared_radius, 1.0));
    float above = max(cosine, -sine) + sine;
    float shown = cosine >= sine ? cosine : above * above / max(4.0 * sine, 1e-30);
    // Its radius as the receiver's plane sees it, and about the share of its area before the plane.
    float tilt = dot(facing, normal);
    float cut = min(to / max(sqrt(squared_radius * max(1.0 - tilt * tilt, 0.0)), 1e-30), 1.0);
    float before = 0.5 + 0.5 * cut * (1.27 - 0.27 * cut * cut);
    return strength * shown / before;
}
#endif
