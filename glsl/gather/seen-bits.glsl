// Visibility by bits: a word for 32 VPLs of the pixel's sample set, layer after layer.
uniform usampler2DArray visible;

uint word(ivec2 pixel, uint index) {
    ivec2 inside = min(pixel, ivec2(view.it.width, view.it.height) - 1);
    int last = textureSize(visible, 0).z - 1;
    return texelFetch(visible, ivec3(inside, min(int(index >> 5), last)), 0).r >> (index & 31u);
}

uvec4 seen(ivec2 pixel, uint index) {
    const int STEP = int(INTERLEAVE);
    return uvec4(word(pixel, index), word(pixel + ivec2(STEP, 0), index), word(pixel + ivec2(0, STEP), index), word(pixel + ivec2(STEP), index));
}
