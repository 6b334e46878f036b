#ifndef INTERLEAVE_GLSL
#define INTERLEAVE_GLSL
// Interleaved sampling: the pixels of a block share out the sample sets. VPL i is in set i modulo SETS; a set's number counts the block's
// pixels row by row.
layout(constant_id = 20) const uint BLOCK_ACROSS = 1;
layout(constant_id = 21) const uint BLOCK_DOWN = 1;
const uint SETS = BLOCK_ACROSS * BLOCK_DOWN;

// Not a constant: no vector of specialization constants is needed, and not every tool folds one.
uvec2 block_size() {
    uint across = BLOCK_ACROSS, down = BLOCK_DOWN;
    return uvec2(across, down);
}

uint number_of(uvec2 set) { return set.y * BLOCK_ACROSS + set.x; }
#endif
