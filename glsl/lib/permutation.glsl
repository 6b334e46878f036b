#ifndef PERMUTATION_GLSL
#define PERMUTATION_GLSL
// Fixed permutation of [0, count): a four-round Feistel network on the next even power of two, iterated until the value is below count.
uint permutation(uint index, uint count) {
    uint half_bits = 1u;
    while ((1u << (2u * half_bits)) < count) half_bits += 1u;
    uint mask = (1u << half_bits) - 1u;
    uint value = index;
    do {
        uint left = value >> half_bits, right = value & mask;
        for (uint round = 0u; round < 4u; round++) {
            uint hashed = (right + 0x9e3779b9u * (round + 1u)) * 0x85ebca6bu;
            hashed ^= hashed >> 15;
            hashed *= 0xc2b2ae35u;
            hashed ^= hashed >> 13;
            uint next = (left ^ hashed) & mask;
            left = right;
            right = next;
        }
        value = (left << half_bits) | right;
    } while (value >= count);
    return value;
}

// Inverse: the index that the permutation maps to `value`.
uint permutation_inverse(uint value, uint count) {
    uint half_bits = 1u;
    while ((1u << (2u * half_bits)) < count) half_bits += 1u;
    uint mask = (1u << half_bits) - 1u;
    uint index = value;
    do {
        uint left = index >> half_bits, right = index & mask;
        for (uint round = 4u; round > 0u; round--) {
            uint hashed = (left + 0x9e3779b9u * round) * 0x85ebca6bu;
            hashed ^= hashed >> 15;
            hashed *= 0xc2b2ae35u;
            hashed ^= hashed >> 13;
            uint before = (right ^ hashed) & mask;
            right = left;
            left = before;
        }
        index = (left << half_bits) | right;
    } while (index >= count);
    return index;
}
#endif
