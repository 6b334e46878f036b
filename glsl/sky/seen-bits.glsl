// Visibility by bits: a word for 32 directions of the pixel's sample set, layer after layer.
uniform usampler2DArray visible;

struct Direction { float none; };

Direction direction_at(uint index) { return Direction(0.0); }

float sky_seen(Direction d, uint within, Receiver r, vec3 facing, float cosine) {
    uint word = texelFetch(visible, ivec3(r.pixel, int(within >> 5)), 0).r;
    return float((word >> (within & 31u)) & 1u);
}
