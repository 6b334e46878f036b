#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Features at the centre of each pixel, as in the rasterizer's G-buffer: normal, distance along the view's axis, position.
#include "bvh/surface.glsl"
#include "lib/view.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(scalar) uniform ViewBlock { View it; } view;
layout(rgba32f) writeonly uniform image2D normals_and_distances;
layout(rgba32f) writeonly uniform image2D positions;

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(uvec2(pixel), uvec2(view.it.width, view.it.height)))) return;
    vec2 ndc = (vec2(pixel) + 0.5) / vec2(view.it.width, view.it.height) * 2.0 - 1.0;
    // The direction has length 1 along the view's axis, so t is the distance along it.
    Ray ray = make_ray(view.it.position, view.it.forward + ndc.x * view.it.right - ndc.y * view.it.up);
    Hit hit = nearest(ray, view.it.near, true);
    vec4 normal = vec4(0.0), position = vec4(0.0);
    if (hit.triangle != NO_TRIANGLE) {
        Surface s = surface_at(ray, hit);
        normal = vec4(s.normal, hit.t);
        position = vec4(s.position, 1.0);
    }
    imageStore(normals_and_distances, pixel, normal);
    imageStore(positions, pixel, position);
}
