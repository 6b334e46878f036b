// Hammersley samples of the reflective shadow maps, drawn by their cells' importance: the inverse of the distribution, rows first.
#include "lib/hammersley.glsl"
#include "vpls/distribution.glsl"
#include "vpls/texel.glsl"

layout(scalar) readonly buffer Columns { float at[]; } columns;
layout(scalar) readonly buffer Rows { float at[]; } rows;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= params.count) return;
    vec2 u = hammersley(permutation(index, params.count), params.count);

    uint low = 0u, high = params.lights * CELLS - 1u;
    float total = rows.at[high], wanted = u.x * total;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (rows.at[middle] > wanted) high = middle;
        else low = middle + 1u;
    }
    uint row = low;
    float before = row > 0u ? rows.at[row - 1u] : 0.0, weight = rows.at[row] - before;
    float down = weight > 0.0 ? clamp((wanted - before) / weight, 0.0, 0.999999) : 0.5;

    low = row * CELLS;
    high = low + CELLS - 1u;
    wanted = u.y * columns.at[high];
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (columns.at[middle] > wanted) high = middle;
        else low = middle + 1u;
    }
    before = low > row * CELLS ? columns.at[low - 1u] : 0.0;
    float chance = columns.at[low] - before;
    float across = chance > 0.0 ? clamp((wanted - before) / chance, 0.0, 0.999999) : 0.5;

    vec2 at = (vec2(low % CELLS, row % CELLS) + vec2(across, down)) / float(CELLS);
    ivec2 texel = min(ivec2(at * vec2(params.size)), ivec2(params.size) - 1);
    float texels = float(params.size.x) * float(params.size.y) / float(CELLS * CELLS);
    put(index, ivec3(texel, row / CELLS), chance > 0.0 ? texels * total / (chance * float(params.count)) : 0.0);
}
