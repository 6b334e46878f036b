// Running sums by a workgroup of 256, monotone to the last bit: an invocation sums a block of neighbours, and the blocks' sums are added
// in sequence. Doubling steps would not be monotone, and would give texels without importance a chance.
layout(local_size_x = 256) in;

shared float blocks[256];
shared float total;

// Sum of all blocks before the invocation's own; `all` is that of all blocks.
float sum_before(float block, out float all) {
    uint me = gl_LocalInvocationIndex;
    blocks[me] = block;
    barrier();
    if (me == 0u) {
        float before = 0.0;
        for (uint i = 0u; i < 256u; i++) {
            float mine = blocks[i];
            blocks[i] = before;
            before = before + mine;
        }
        total = before;
    }
    barrier();
    all = total;
    return blocks[me];
}
