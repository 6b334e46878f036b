// Light lists of froxels in parts: part p holds VPLs p, p + PARTS, ... by their numbers within the part. A part's words are the count of its
// VPLs, then the numbers, PACKED to a word (Linke 2016, section 4.6.1: 8 bits are enough for each).
layout(constant_id = 8) const uint PARTS = 16; // a multiple of the sample sets
layout(constant_id = 9) const uint PACKED = 4; // 1, 2 or 4

const uint LIST_BITS = 32u / PACKED;

// Words of a part, of `count` VPLs in all.
uint part_words(uint count) { return 1u + ((count + PARTS - 1u) / PARTS + PACKED - 1u) / PACKED; }
