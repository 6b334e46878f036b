// A bilateral filter with a Gaussian's weights (Aranha et al., section III-D); the standard deviation is a third of the radius. With twice the
// interleaving's n as the radius they sum to the same over every sample set, to a hundredth.
float weight_of(int offset, int radius) {
    float deviations = 3.0 * float(offset) / float(radius);
    return exp(-0.5 * deviations * deviations);
}

float likeness(float off_plane, float cosine, float min_cosine) { return float(off_plane <= 1.0 && cosine >= min_cosine); }
