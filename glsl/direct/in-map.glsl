// Shadows from shadow maps. An includer defines
//     float shadow(Light light, uint layer, vec2 uv, float distance);
// the share of light that arrives at a distance along the map's axis.
float shadow(Light light, uint layer, vec2 uv, float distance);

// Visibility of a light from a point; 0 outside of its map.
float visibility(Light light, uint layer, vec3 x, vec3 n) {
    // The point itself decides which map it is in; the lifted point below may leave the map at a spot's rim or a seam of a point light.
    vec4 clip = light.world_to_clip * vec4(x, 1.0);
    if (clip.w <= 0.0 || any(greaterThan(abs(clip.xy), vec2(clip.w)))) return 0.0;
    // Lifted off the surface by the bias, and so far that no texel of the filter window lies above the surface: moved by up to `lift`
    // texels across the map, the lifted point stays on the light's side of the surface's plane.
    vec2 texels = 2.0 / vec2(params.map_size) * (light.kind == DIRECTIONAL ? 1.0 : dot(x - light.origin, light.direction));
    float slope = dot(texels, abs(vec2(dot(n, light.right), dot(n, light.up))));
    vec3 lifted = x + n * (params.bias + params.lift * slope);
    clip = light.world_to_clip * vec4(lifted, 1.0);
    // Nothing fits between surface and light at this distance.
    if (clip.w <= 0.0) return 1.0;
    return shadow(light, layer, clip.xy / clip.w * 0.5 + 0.5, dot(lifted - light.origin, light.direction));
}
