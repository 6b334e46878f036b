// The whole sky is seen.
float sky_seen(uint index, uint within, Receiver r, vec3 facing, float cosine) { return 1.0; }
