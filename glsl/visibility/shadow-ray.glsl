// A shadow ray between a pixel's surface and a virtual point light.
#include "bvh/hole.glsl"
#include "gbuffer/receiver.glsl"

// Position lifted off a surface that was reconstructed from depth. Rasterizers snap corners by up to a 256th of a pixel, which moves the
// surface by up to `off`, metres.
vec3 lifted(vec3 position, vec3 n, float off) { return off_surface(position + n * (off + 2e-6 * view.it.diagonal), n); }

// Start of the shadow rays of a receiver.
vec3 ray_start(Receiver r) {
    return lifted(r.position, r.normal, r.distance * length(view.it.up) / (128.0 * float(view.it.height)));
}

// Whether nothing stands between the start and a VPL.
bool reaches(vec3 from, vec3 position, vec3 facing) {
    return !is_occluded(make_ray(from, lifted(position, facing, 2e-5 * view.it.diagonal) - from), 1.0);
}
