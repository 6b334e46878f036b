// Colour of a number in [0, 1]: from blue over green to red.
vec3 false_color(float t) { return clamp(1.5 - abs(4.0 * t - vec3(3.0, 2.0, 1.0)), 0.0, 1.0); }
