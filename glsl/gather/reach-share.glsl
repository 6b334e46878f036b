// Proxy lights with shadows.
layout(scalar) readonly buffer Seen { float at[]; } seen;

float reach_of(uint proxy_number) { return seen.at[proxy_number]; }
