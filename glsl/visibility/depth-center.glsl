// Depth of a splat's middle. Each part for "depth" writes that of a texel of the map.
void put_depth(ivec2 texel) {}
