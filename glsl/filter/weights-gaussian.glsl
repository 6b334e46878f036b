// Gaussian weights (Aranha et al., section III-D) with a standard deviation of a third of the radius, cut off at the radius. With a radius
// of twice the interleaving's n they sum to the same over every sample set within a hundredth.
float weight_of(int offset, int radius) {
    float deviations = 3.0 * float(offset) / float(radius);
    return exp(-0.5 * deviations * deviations);
}

float likeness(float off_plane, float cosine, float min_cosine) { return float(off_plane <= 1.0 && cosine >= min_cosine); }
