// A cross bilateral filter (Eisemann and Durand 2004; Petschnigg et al. 2004) of what the G-buffer says, along rows and columns: the thresholds are
// where its Gaussians are at e^-2. In the picture's plane weights fall linearly, so that the interleaving's pattern goes entirely.
float weight_of(int offset, int radius) { return float(radius - abs(offset)); }

float likeness(float off_plane, float cosine, float min_cosine) {
    float turned = (1.0 - cosine) / max(1.0 - min_cosine, 1e-6);
    return exp(-2.0 * (off_plane * off_plane + turned));
}
