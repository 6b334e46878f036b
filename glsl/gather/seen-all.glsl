// All VPLs are visible. Each part for "seen" defines
//     uvec4 seen(ivec2 pixel, uint index);
// the visibility of the sample set's VPLs from `index` on: bit i of a word is VPL index + i, up to the next multiple of 32. The four words
// are of the given pixel, and of those one step across, down, and both.
uvec4 seen(ivec2 pixel, uint index) { return uvec4(~0u); }
