// Weights fall as a Gaussian's (Aranha et al., section III-D) whose standard deviation is a third of the radius. Cut off there, they sum to
// the same over every sample set, to a hundredth, where the radius is twice the interleaving's n.
float weight_of(int offset, int radius) {
    float deviations = 3.0 * float(offset) / float(radius);
    return exp(-0.5 * deviations * deviations);
}

float likeness(float off_plane, float cosine, float min_cosine) { return float(off_plane <= 1.0 && cosine >= min_cosine); }
