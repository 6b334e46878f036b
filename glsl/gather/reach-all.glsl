// Proxy lights without shadows. Each part for "reach" defines
//     float reach_of(uint proxy_number);
// the share of a proxy's light that reaches its cache.
float reach_of(uint proxy_number) { return 1.0; }
