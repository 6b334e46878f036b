// Random places in small triangles: points of masked surfaces lie there, since a mask that repeats could miss all centres of small triangles,
// or hit them all.

// Corners of small triangle k of level n, barycentric coordinates in units of 1 / (3 n): `small_triangle` of visibility/point.glsl has the
// order.
void small_corners(uint k, uint n, out uvec3 corner[3]) {
    uint j = 0u;
    uint m = n;
    for (; m > 1u && k >= 6u * (m - 1u); m -= 2u) {
        k -= 6u * (m - 1u);
        j++;
    }
    // Places along the ring's edge, and whether they are on the next ring inside.
    uvec3 along = uvec3(0u, 1u, 0u), inside = uvec3(0u);
    uint side = 0u;
    if (m > 1u) {
        uint strip = 2u * m - 2u;
        side = k / strip;
        uint t = k - side * strip;
        uint i = (t + 1u) >> 1u;
        bool leans = 2u * i < m;
        if (t == 0u) {
            along = uvec3(0u, 1u, 1u);
            inside = uvec3(0u, 0u, 1u);
        } else if (t == strip - 1u) {
            along = uvec3(m - 1u, m, m - 1u);
            inside = uvec3(0u, 0u, 1u);
        } else if ((t & 1u) != 0u) {
            along = uvec3(i, i + 1u, leans ? i + 1u : i);
            inside = uvec3(0u, 0u, 1u);
        } else {
            along = uvec3(i, i + 1u, leans ? i : i + 1u);
            inside = uvec3(1u, 1u, 0u);
        }
    }
    for (uint i = 0u; i < 3u; i++) {
        uint x = 2u * j + 3u * along[i] - inside[i], up = 2u * j + 2u * inside[i];
        // The one triangle in the middle has its third corner opposite the edge.
        if (m <= 1u && i == 2u) up += 3u;
        uvec3 b = uvec3(3u * n - x - up, x, up);
        corner[i] = side == 0u ? b : side == 1u ? b.zxy : b.yzx;
    }
}

// Weights of the corners of a small triangle for a random place in it. The corners' coordinates give their order, so that the place is the
// same whoever lists them.
vec3 random_weights(uvec3 a, uvec3 b, uvec3 c, uvec2 hash) {
    vec2 u = vec2(hash >> 8u) / 16777216.0;
    float s = sqrt(u.x);
    vec3 weights = vec3(1.0 - s, s * (1.0 - u.y), s * u.y);
    uvec3 key = uvec3(a.x, b.x, c.x) << 8u | uvec3(a.y, b.y, c.y);
    uint first = uint(key.x > key.y) + uint(key.x > key.z), second = uint(key.y > key.x) + uint(key.y > key.z);
    return vec3(weights[first], weights[second], weights[3u - first - second]);
}
