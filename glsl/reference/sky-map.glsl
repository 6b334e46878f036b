// A sky whose directions are sampled by the luminance of its map.
#include "sky/radiance-map.glsl"

const bool SKY_SAMPLED = true;

uniform sampler2D sky_rows; // running share of the light in the rows

float row_sum(int y) { return y < 0 ? 0.0 : texelFetch(sky_rows, ivec2(y, 0), 0).r; }
float column_sum(int x, int y) { return x < 0 ? 0.0 : texelFetch(sky_map, ivec2(x, y), 0).a; }

// Solid angle of a texel of row y, sr.
float sky_texel(int y) {
    ivec2 size = textureSize(sky_map, 0);
    vec2 edges = cos(PI * vec2(float(y), float(y + 1)) / float(size.y));
    return 2.0 * PI / float(size.x) * (edges.x - edges.y);
}

float density_of_texel(ivec2 texel) {
    float share = (row_sum(texel.y) - row_sum(texel.y - 1)) * (column_sum(texel.x, texel.y) - column_sum(texel.x - 1, texel.y));
    return share / sky_texel(texel.y);
}

float sky_density(vec3 w) {
    ivec2 size = textureSize(sky_map, 0);
    return density_of_texel(clamp(ivec2(sky_place(w)), ivec2(0), size - 1));
}

vec3 sample_sky(vec2 u, out vec3 w, out float density) {
    ivec2 size = textureSize(sky_map, 0), low = ivec2(0), high = size - 1;
    while (low.y < high.y) {
        int middle = (low.y + high.y) / 2;
        if (row_sum(middle) <= u.y) low.y = middle + 1;
        else high.y = middle;
    }
    while (low.x < high.x) {
        int middle = (low.x + high.x) / 2;
        if (column_sum(middle, low.y) <= u.x) low.x = middle + 1;
        else high.x = middle;
    }
    vec2 before = vec2(column_sum(low.x - 1, low.y), row_sum(low.y - 1));
    vec2 width = vec2(column_sum(low.x, low.y), row_sum(low.y)) - before;
    vec2 within = clamp((u - before) / max(width, 1e-12), 0.0, 0.999999);
    float across = 2.0 * PI * ((float(low.x) + within.x) / float(size.x) - sky.turn);
    vec2 edges = cos(PI * vec2(float(low.y), float(low.y + 1)) / float(size.y));
    float cosine = mix(edges.x, edges.y, within.y), sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    w = vec3(sin(across) * sine, cosine, -cos(across) * sine);
    density = density_of_texel(low);
    return density > 0.0 ? sky_radiance(w) / density : vec3(0.0);
}
