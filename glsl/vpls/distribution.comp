#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Running sums of the cells' importance along each row, and of the rows over all layers, for sampling by inversion. A cell gets the largest
// importance of its neighbourhood, lest texels that its few samples missed give VPLs that are too bright.
#include "vpls/distribution.glsl"

layout(local_size_x = 256) in;

layout(scalar, push_constant) uniform Params { uint layers; } params;

layout(scalar) readonly buffer Importances { float at[]; } importances;
layout(scalar) writeonly buffer Columns { float at[]; } columns; // of all cells: inclusive, along their row
layout(scalar) writeonly buffer Rows { float at[]; } rows;       // of all layers' rows: inclusive

shared float sums[256];

float importance(uint layer, int x, int y) {
    if (min(x, y) < 0 || max(x, y) >= int(CELLS)) return 0.0;
    return importances.at[(layer * CELLS + uint(y)) * CELLS + uint(x)];
}

void main() {
    uint me = gl_LocalInvocationIndex;
    float before = 0.0;
    for (uint first = 0u; first < params.layers * CELLS; first += 256u) {
        uint row = first + me;
        float sum = 0.0;
        if (row < params.layers * CELLS) {
            uint layer = row / CELLS;
            int y = int(row % CELLS);
            for (int x = 0; x < int(CELLS); x++) {
                float most = 0.0;
                for (int down = -1; down <= 1; down++) {
                    for (int across = -1; across <= 1; across++) most = max(most, importance(layer, x + across, y + down));
                }
                sum += most;
                columns.at[row * CELLS + uint(x)] = sum;
            }
        }
        sums[me] = sum;
        barrier();
        if (me == 0u) {
            for (uint i = 0u; i < min(params.layers * CELLS - first, 256u); i++) {
                before += sums[i];
                rows.at[first + i] = before;
            }
        }
        barrier();
    }
}
