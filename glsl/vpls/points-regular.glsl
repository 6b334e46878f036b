// A regular pattern over light and row in one, and column, in the order of a fixed permutation.
#include "lib/permutation.glsl"
#include "vpls/grid.glsl"

// The pattern is square over the unit square; 65,536 is so large that it limits nothing.
const uvec2 SQUARE = uvec2(65536u);

vec4 point(uint index, uint step) {
    uvec2 at, grid;
    grid_sample(permutation(index, params.count), params.count, SQUARE, at, grid);
    vec2 u = fract((vec2(at) + 0.5 + params.shift.xy) / vec2(grid));
    return vec4(u.y, u.x, 0.0, 0.0);
}

float share(uint index) {
    uvec2 at, grid;
    grid_sample(permutation(index, params.count), params.count, SQUARE, at, grid);
    return 1.0 / (float(grid.x) * float(grid.y));
}
