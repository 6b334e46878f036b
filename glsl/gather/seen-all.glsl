// Pixels see every VPL. Each part for "seen" defines the bits of the set's VPLs that pixels see, from number `index` on: bit i for VPL index + i, up to
// the next multiple of 32. The words are for the given pixel, and for those a step across, down, and both.
uvec4 seen(ivec2 pixel, uint index) { return uvec4(~0u); }
