// Texels of imperfect shadow maps during construction, and layout of the maps.
const uint EMPTY = 0xffffffffu;

// Distance over `far` in 24 bits above the radius in 8: a nearer point is less, whatever its radius. The radius is in texels of the finest
// level, 16 steps an octave.
uint pack_pixel(float depth, float radius) {
    uint d = uint(clamp(depth, 0.0, 1.0) * 16777214.0);
    uint r = uint(clamp(96.5 + 16.0 * log2(radius), 1.0, 255.0));
    return d << 8 | r;
}

float pixel_depth(uint word) { return float(word >> 8) / 16777214.0; }
float pixel_radius(uint word) { return exp2((float(word & 255u) - 96.0) / 16.0); }

// Corner of a VPL's map in the image of all maps.
ivec2 map_corner(uint vpl, uint columns, int size) { return ivec2(vpl % columns, vpl / columns) * size; }
