// A sky from a map in latitude and longitude, bilinear between texel centres. `SkyMap` of src/scene/sky.rs is the host's twin.
#include "lib/pi.glsl"

layout(scalar) uniform SkyBlock {
    vec3 radiance; // factor of the map's
    float turn;    // of the map about +Y, in turns
} sky;
uniform sampler2D sky_map; // radiance, and the running share of the row's light

// Place in the map of a direction w of unit length, in texels.
vec2 sky_place(vec3 w) {
    float across = w.x == 0.0 && w.z == 0.0 ? 0.0 : atan(w.x, -w.z) / (2.0 * PI);
    return vec2(fract(across + sky.turn), acos(clamp(w.y, -1.0, 1.0)) / PI) * vec2(textureSize(sky_map, 0));
}

vec3 sky_radiance(vec3 w) {
    ivec2 size = textureSize(sky_map, 0);
    vec2 at = sky_place(normalize(w)) - 0.5, low = floor(at), part = at - low;
    int left = int(low.x) < 0 ? size.x - 1 : int(low.x), right = int(low.x) + 1 >= size.x ? 0 : int(low.x) + 1;
    int top = clamp(int(low.y), 0, size.y - 1), bottom = clamp(int(low.y) + 1, 0, size.y - 1);
    vec3 above = mix(texelFetch(sky_map, ivec2(left, top), 0).rgb, texelFetch(sky_map, ivec2(right, top), 0).rgb, part.x);
    vec3 below = mix(texelFetch(sky_map, ivec2(left, bottom), 0).rgb, texelFetch(sky_map, ivec2(right, bottom), 0).rgb, part.x);
    return mix(above, below, part.y) * sky.radiance;
}
