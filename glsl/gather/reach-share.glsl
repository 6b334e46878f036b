// Proxy lights with shadows.
layout(scalar) readonly buffer Seen { float at[]; } seen;

float reach_of(uint cache_number) { return seen.at[cache_number]; }
