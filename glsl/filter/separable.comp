#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// One direction of a separable filter that keeps to a pixel's own surface. Each part for "weights" defines
//     float weight_of(int offset, int radius);
// the weight of a pixel at an offset, 0 from the radius on; and
//     float likeness(float off_plane, float cosine, float min_cosine);
// the weight of a pixel by its distance from the tangent plane, in units of `plane_distance`, and by the cosine between normals. It is 1
// for the pixel itself.
#include "lib/packing.glsl"
#include "lib/view.glsl"

layout(local_size_x = 32, local_size_y = 2) in;
layout(constant_id = 0) const bool VERTICAL = false;

layout(scalar, push_constant) uniform Params {
    int radius;               // the weight is 0 at this distance, pixels
    float min_cosine;         // between normals
    float plane_distance;     // limit of the distance from the tangent plane, relative to the pixel's distance
} params;

layout(scalar) uniform ViewBlock { View it; } view;
uniform sampler2D depth;
layout(rg16_snorm) readonly uniform image2D normal;
layout(rgba16f) readonly uniform image2D noisy;
layout(rgba16f) writeonly uniform image2D smoothed;

#include "part/weights=filter/weights-bilateral"

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = ivec2(view.it.width, view.it.height);
    if (any(greaterThanEqual(pixel, size))) return;
    vec4 own = imageLoad(noisy, pixel);
    float z = texelFetch(depth, pixel, 0).r;
    if (z <= 0.0) {
        imageStore(smoothed, pixel, own);
        return;
    }
    vec3 x = view_position(view.it, pixel, z);
    vec3 n = octahedral_inverse(imageLoad(normal, pixel).xy);
    float reach = params.plane_distance * view.it.near / z;
    float weights = weight_of(0, params.radius);
    vec3 sum = own.rgb * weights;
    ivec2 direction = ivec2(1, 0);
    if (VERTICAL) direction = ivec2(0, 1);
    for (int offset = 1 - params.radius; offset < params.radius; offset++) {
        ivec2 other = pixel + direction * offset;
        if (offset == 0 || any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, size))) continue;
        float other_z = texelFetch(depth, other, 0).r;
        if (other_z <= 0.0) continue;
        float distance = abs(dot(n, view_position(view.it, other, other_z) - x));
        float cosine = dot(n, octahedral_inverse(imageLoad(normal, other).xy));
        float weight = weight_of(offset, params.radius) * likeness(distance / reach, cosine, params.min_cosine);
        if (weight > 0.0) {
            sum += imageLoad(noisy, other).rgb * weight;
            weights += weight;
        }
    }
    imageStore(smoothed, pixel, vec4(sum / weights, 1.0));
}
