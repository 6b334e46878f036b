// Radical inverse of k in a base: element k of the van der Corput sequence, in [0, 1). It is exact for whole numbers below 2^24.
float radical_inverse(uint k, uint base) {
    uint reversed = 0u, scale = 1u;
    for (; k > 0u; k /= base) {
        reversed = reversed * base + k % base;
        scale *= base;
    }
    return float(reversed) / float(scale);
}
