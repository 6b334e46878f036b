// Visibility from the lights' shadow maps. Whoever includes it defines the share of light that arrives at a distance along the map's axis:
//     float shadow(Light light, uint layer, vec2 uv, float distance);
float shadow(Light light, uint layer, vec2 uv, float distance);

// The share of the light that arrives at a point; none outside of the light's map.
float visibility(Light light, uint layer, vec3 x, vec3 n) {
    // The point itself says which map it is in: the one lifted below may leave it at a spot's rim or a seam of a point light.
    vec4 clip = light.world_to_clip * vec4(x, 1.0);
    if (clip.w <= 0.0 || any(greaterThan(abs(clip.xy), vec2(clip.w)))) return 0.0;
    // Off the surface by the bias, and so far that no texel of the window that is looked at lies above the surface: moved by up to
    // `lift` texels across the map, the lifted point must stay on the light's side of the surface's plane.
    vec2 texels = 2.0 / vec2(params.map_size) * (light.kind == DIRECTIONAL ? 1.0 : dot(x - light.origin, light.direction));
    float slope = dot(texels, abs(vec2(dot(n, light.right), dot(n, light.up))));
    vec3 lifted = x + n * (params.bias + params.lift * slope);
    clip = light.world_to_clip * vec4(lifted, 1.0);
    // A light so near to the surface has nothing before it.
    if (clip.w <= 0.0) return 1.0;
    return shadow(light, layer, clip.xy / clip.w * 0.5 + 0.5, dot(lifted - light.origin, light.direction));
}
