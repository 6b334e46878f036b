// Means of textures over a footprint that is larger than a fragment.

// `bias` mips coarser than a fragment. It is no bias of the sampler, which devices may bound by 2.
vec4 mean_over(sampler2DArray map, vec3 coordinates, float bias) {
    return textureLod(map, coordinates, textureQueryLod(map, coordinates.xy).y + bias);
}
