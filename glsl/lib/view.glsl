#ifndef VIEW_GLSL
#define VIEW_GLSL
// The camera in the layout of src/world/projection.rs.
struct View {
    mat4 view_projection;
    vec3 position;
    float near;
    vec3 right; // scaled by the tangent of half the horizontal field of view
    uint width;
    vec3 up;    // scaled by the tangent of half the vertical field of view
    uint height;
    vec3 forward;
    float diagonal; // of the scene's bounds, metres
};

// World position of a pixel's centre, given a depth of the reversed, infinite projection that is not 0.
vec3 view_position(View view, ivec2 pixel, float depth) {
    vec2 ndc = (vec2(pixel) + 0.5) / vec2(view.width, view.height) * 2.0 - 1.0;
    vec3 ray = view.forward + ndc.x * view.right - ndc.y * view.up;
    return view.position + ray * (view.near / depth);
}
#endif
