// Tent weights (Laine et al. 2007; Linke 2016, 4.5). With a radius of the interleaving's n they sum to the same over every sample set,
// which removes its pattern entirely.
float weight_of(int offset, int radius) { return float(radius - abs(offset)); }

float likeness(float off_plane, float cosine, float min_cosine) { return float(off_plane <= 1.0 && cosine >= min_cosine); }
