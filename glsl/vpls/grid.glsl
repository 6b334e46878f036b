// Sample k of `count` in a regular pattern over a map of `size` texels: rows with a spacing as nearly square as whole numbers allow. Rows
// differ by at most one sample. `at` is the sample's column and row, `grid` the number of samples in its row, and of rows.
void grid_sample(uint k, uint count, uvec2 size, out uvec2 at, out uvec2 grid) {
    uint rows = clamp(uint(round(sqrt(float(count) * float(size.y) / float(size.x)))), 1u, min(count, size.y));
    uint in_row = count / rows, longer = count % rows;
    uint in_longer = (in_row + 1u) * longer;
    uint row = k < in_longer ? k / (in_row + 1u) : longer + (k - in_longer) / in_row;
    grid = uvec2(in_row + uint(row < longer), rows);
    at = uvec2(k - (row * in_row + min(row, longer)), row);
}
