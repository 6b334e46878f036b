// Caches with a light of diffuse light and one of glossy light.
const uint PROXIES = 2u;
