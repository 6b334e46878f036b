// The picture itself. Each part for "shown" defines
//     vec3 displayed(ivec2 pixel, vec3 picture, vec3 indirect); // sRGB-encoded, from the encoded picture and the indirect radiance
vec3 displayed(ivec2 pixel, vec3 picture, vec3 indirect) { return picture; }
