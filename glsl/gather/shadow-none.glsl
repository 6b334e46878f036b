// No shadows. Each part for "shadow" defines Shadow, the per-VPL data of the test, and these functions.
struct Shadow { float none; };

// Data of VPL number `vpl`.
Shadow shadow_of(uint vpl, vec3 position, vec3 facing) { return Shadow(0.0); }

// Data broadcast from lane `lane` of the subgroup.
Shadow hand_round(Shadow shadow, uint lane) { return shadow; }

// Share of the VPL's light that arrives at a receiver, given the receiver's normal, the vector `way` to the VPL with its squared length,
// and the cosines to the VPL's normal and to the receiver's, both times the length.
float lit(Shadow shadow, vec3 normal, vec3 way, float squared, float from, float to) { return 1.0; }
