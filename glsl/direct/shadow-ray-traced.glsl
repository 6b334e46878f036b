// Shadows by rays: exact, and slower than maps.
#include "bvh/hole.glsl"

float visibility(Light light, uint layer, vec3 x, vec3 n) {
    if (light.kind == POINT_FACE) {
        // A face of a point light lights only its own part of the sphere.
        vec4 clip = light.world_to_clip * vec4(x, 1.0);
        if (clip.w <= 0.0 || any(greaterThan(abs(clip.xy), vec2(clip.w)))) return 0.0;
    }
    // Rasterizers snap corners by up to a 256th of a pixel, which moves surfaces as much; `off` covers it.
    float off = dot(x - view.it.position, view.it.forward) * length(view.it.up) / (128.0 * float(view.it.height));
    vec3 from = off_surface(x + n * (off + 2e-6 * view.it.diagonal), n);
    bool occluded;
    if (light.kind == DIRECTIONAL) {
        occluded = is_occluded(make_ray(from, -light.direction), 1e30);
    } else {
        occluded = is_occluded(make_ray(from, light.origin - from), 0.9999);
    }
    return occluded ? 0.0 : 1.0;
}
