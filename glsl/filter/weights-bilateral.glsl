// A bilateral filter whose weights fall linearly (Laine et al. 2007; Linke 2016, section 4.5). With the interleaving's n as the radius they sum to the
// same over every sample set, so that the pattern goes entirely.
float weight_of(int offset, int radius) { return float(radius - abs(offset)); }

float likeness(float off_plane, float cosine, float min_cosine) { return float(off_plane <= 1.0 && cosine >= min_cosine); }
