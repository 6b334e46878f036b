// Diffuse proxy lights of caches.
#include "lib/light-cache.glsl"
#include "part/proxies=gather/proxies-one"

layout(scalar) readonly buffer Caches { LightCache at[]; } caches;
layout(scalar) readonly buffer Proxies { ProxyLight at[]; } proxies;

bool is_marked(uint index) { return any(greaterThan(proxies.at[index * PROXIES].irradiance, vec3(0.0))); }
vec3 place_of(uint index) { return caches.at[index].position + proxies.at[index * PROXIES].way; }
