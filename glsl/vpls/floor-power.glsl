// Importance with a share by power.
layout(scalar) readonly buffer Floor { float it; } least;

float least_importance() { return least.it; }
