// A cross bilateral filter (Eisemann and Durand 2004; Petschnigg et al. 2004) guided by the G-buffer, along rows and columns. The Gaussians
// of plane distance and normal are at e^-2 at the thresholds. In the picture's plane weights are a tent, which removes the interleaving's
// pattern entirely.
float weight_of(int offset, int radius) { return float(radius - abs(offset)); }

float likeness(float off_plane, float cosine, float min_cosine) {
    float turned = (1.0 - cosine) / max(1.0 - min_cosine, 1e-6);
    return exp(-2.0 * (off_plane * off_plane + turned));
}
