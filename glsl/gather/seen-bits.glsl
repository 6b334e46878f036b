// Visibility by bits: a word for 32 VPLs of the pixel's sample set, layer after layer.
uniform usampler2DArray visible;

uint word(ivec2 pixel, uint index) {
    ivec2 inside = min(pixel, ivec2(view.it.width, view.it.height) - 1);
    int last = textureSize(visible, 0).z - 1;
    return texelFetch(visible, ivec3(inside, min(int(index >> 5), last)), 0).r >> (index & 31u);
}

uvec4 seen(ivec2 pixel, uint index) {
    ivec2 next = ivec2(block_size());
    return uvec4(word(pixel, index), word(pixel + ivec2(next.x, 0), index), word(pixel + ivec2(0, next.y), index), word(pixel + next, index));
}
