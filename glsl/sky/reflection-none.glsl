// Receivers without gloss.
struct Reflection { float none; };

Reflection reflection_at(Receiver r) { return Reflection(0.0); }
float reflect_to_eye(inout Reflection g, Receiver r, vec3 to_light, vec3 irradiance) { return 1.0; }
void store(Receiver r, Reflection g) {}
