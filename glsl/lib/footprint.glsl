// Means of textures over a footprint that is larger than a fragment.

// The mean over a footprint that is this many mips coarser than a fragment. Devices may bound a sampler's bias by 2, so it is no bias.
vec4 mean_over(sampler2DArray map, vec3 coordinates, float mips) {
    return textureLod(map, coordinates, textureQueryLod(map, coordinates.xy).y + mips);
}
