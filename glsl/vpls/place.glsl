// Texel of a uniform point over light, column and row; the texel's layer is the light's map.
ivec3 place_of(vec4 u) {
    uint layer = min(uint(u.x * float(params.lights)), params.lights - 1u);
    return ivec3(min(ivec2(u.yz * vec2(params.size)), ivec2(params.size) - 1), layer);
}
