// Froxels of the pixels of a sample set: tiles of 16 x 16 pixels, cut into 32 slices by distance (Oertegren and Persson 2016). The first
// slice ends at a 64th of the scene's diagonal; the others grow by a constant factor.
const uint SHELL_TILE = 16u;
const uint SHELL_SLICES = 32u;

uint shell_slice(float distance, float diagonal) {
    float t = log2(max(distance * 64.0 / diagonal, 1e-9)) / 6.0;
    return uint(clamp(t * float(SHELL_SLICES - 1u) + 1.0, 0.0, float(SHELL_SLICES) - 0.5));
}
