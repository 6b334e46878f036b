// Proxy lights without shadows. Each part for "reach" defines
//     float reach_of(uint cache_number);
// the share of a cache's light that reaches it.
float reach_of(uint cache_number) { return 1.0; }
