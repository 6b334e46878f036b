// VPLs without shadows. Each part for "shadow" defines Shadow, what a VPL's test needs, and these functions.
struct Shadow { float none; };

// What the test of VPL number `vpl` needs.
Shadow shadow_of(uint vpl, vec3 position, vec3 facing) { return Shadow(0.0); }

// The Shadow that invocation `lane` of the subgroup has.
Shadow hand_round(Shadow shadow, uint lane) { return shadow; }

// The share of the VPL's light that arrives at a receiver: the receiver's normal, `way` to the VPL, its squared length, and the cosines to the
// VPL's normal and to the receiver's, both times the length.
float lit(Shadow shadow, vec3 normal, vec3 way, float squared, float from, float to) { return 1.0; }
