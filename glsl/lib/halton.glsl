#ifndef HALTON_GLSL
#define HALTON_GLSL
// Radical inverse of k in a base: element k of the van der Corput sequence, in [0, 1). Digits are reversed in whole numbers, so that every
// k has its own point until a step of 2^-24 is finer than a float. The last digits of a large k move a point by less than that.
float radical_inverse(uint k, uint base) {
    uint reversed = 0u, scale = 1u, most = 0xffffffffu / base;
    for (; k > 0u && scale <= most; k /= base) {
        reversed = reversed * base + k % base;
        scale *= base;
    }
    return min(float(reversed) / float(scale), 16777215.0 / 16777216.0);
}
#endif
