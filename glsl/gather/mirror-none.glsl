// Receivers without gloss.
float mirror(Receiver r, vec3 to_light) { return 1.0; }
