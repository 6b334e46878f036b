// Receivers without gloss.
void begin_reflection(Receiver r) {}
float reflect_to_eye(Receiver r, vec3 to_light, vec3 irradiance) { return 1.0; }
void end_reflection(Receiver r) {}
