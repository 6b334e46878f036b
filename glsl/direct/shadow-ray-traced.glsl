// Shadow rays: exact.
#include "bvh/hole.glsl"

float visibility(Light light, uint layer, vec3 x, vec3 n) {
    if (light.kind == POINT_FACE) {
        // Each face of a point light lights what it looks at.
        vec4 clip = light.world_to_clip * vec4(x, 1.0);
        if (clip.w <= 0.0 || any(greaterThan(abs(clip.xy), vec2(clip.w)))) return 0.0;
    }
    // Rasterizers move corners by up to a 256th of a pixel, and surfaces with them.
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
