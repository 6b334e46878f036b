// Caches with one light each, of diffuse light. Each part for "proxies" defines PROXIES, the lights of a cache.
const uint PROXIES = 1u;
