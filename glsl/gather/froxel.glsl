#ifndef FROXEL_GLSL
#define FROXEL_GLSL
// Parts of the view's frustum, and the test of VPLs against them.
#include "lib/view.glsl"

// The part of the view's frustum between two distances along its axis, in a rectangle of pixels.
struct Frustum {
    vec3 eye;
    vec3 rays[4]; // to the rectangle's corners, of length 1 along the axis
    float near;
    float far;
    float slack; // metres, far more than the rounding of positions
};

Frustum frustum(View view, ivec2 low, ivec2 high, float near, float far) {
    Frustum f;
    f.eye = view.position;
    for (int i = 0; i < 4; i++) {
        vec2 corner = vec2((i & 1) == 0 ? low.x : high.x, (i & 2) == 0 ? low.y : high.y);
        vec2 ndc = corner / vec2(view.width, view.height) * 2.0 - 1.0;
        f.rays[i] = view.forward + ndc.x * view.right - ndc.y * view.up;
    }
    f.near = near;
    f.far = far;
    f.slack = 1e-5 * (far + view.diagonal);
    return f;
}

// Whether a VPL's hemisphere reaches into the frustum: whether any of the eight corners is in front of it. An empty frustum is never lit.
bool is_lit(Frustum f, vec3 position, vec3 facing) {
    float from_eye = dot(facing, f.eye - position);
    float most = -1.0;
    for (int i = 0; i < 4; i++) {
        float along = dot(facing, f.rays[i]);
        most = max(most, max(from_eye + along * f.near, from_eye + along * f.far));
    }
    return f.near <= f.far && most > -f.slack;
}

// Froxels (Linke 2016, section 4.6.1): tiles of 128 x 128 pixels, cut into 16 slices by distance. The first slice is larger (Persson and
// Olsson 2013); the others grow by a constant factor, up to the scene's diagonal.
const int FROXEL_TILE = 128;
const uint SLICES = 16u;
const float FIRST_SLICE = 1.0 / 32.0; // of the diagonal

uint slice_of(View view, float distance) {
    float t = log2(max(distance / (FIRST_SLICE * view.diagonal), 1e-9)) / -log2(FIRST_SLICE);
    return uint(clamp(t * float(SLICES - 1u) + 1.0, 0.0, float(SLICES) - 0.5));
}

// Near distance of a slice. The last slice has no end.
float slice_begin(View view, uint slice) {
    return slice == 0u ? 0.0 : FIRST_SLICE * view.diagonal * exp2(-log2(FIRST_SLICE) * (float(slice) - 1.0) / float(SLICES - 1u));
}
#endif
