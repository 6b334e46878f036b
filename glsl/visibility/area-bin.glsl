// Histogram of the areas of triangles: 64 bins an octave, from 2^-40 to 2^24 m^2.
struct AreaBin {
    uint count;
    uint largest; // bits of a positive float, which are in the floats' order
};

const uint AREA_BINS = 4096u;

uint area_bin(float area) { return uint(clamp(int(floatBitsToUint(area) >> 17u) - 64 * (127 - 40), 0, int(AREA_BINS) - 1)); }
