#ifndef POINT_GLSL
#define POINT_GLSL
// Points from triangles (Linke 2016, section 4.4.1): the rule shared by the tessellator's and the compute shader's points.
//
// A triangle is cut into s * s congruent ones, and each of these is tessellated with all levels n, equally spaced. A point represents a
// small triangle, at its centre. The level n is the least that keeps small triangles' area at or below `max_area`; s is the least that
// keeps n at or below MOST_LEVEL, since lavapipe loses patches in larger batches.
#include "lib/packing.glsl"
#include "lib/pi.glsl"
#include "lib/random.glsl"

const uint MOST_LEVEL = 15u;

// A point: 16 bytes.
struct Point {
    vec3 position;
    uint packed; // normal, octahedral, 2 x 10 bits; log2 of the radius, 11 bits; double-sided, 1 bit
};

struct Subdivision {
    uint split; // s
    uint level; // n
};

uint tessellation_level(float area, float max_area) {
    // All small triangles but the middle one have 2 / (3 n^2) of the area.
    return area <= max_area ? 1u : max(2u, uint(min(ceil(sqrt(area * (2.0 / 3.0) / max_area)), 32768.0)));
}

Subdivision subdivision(float area, float max_area) {
    uint n = tessellation_level(area, max_area);
    uint s = (n + MOST_LEVEL - 1u) / MOST_LEVEL;
    return Subdivision(s, s == 1u ? n : min(tessellation_level(area / float(s * s), max_area), MOST_LEVEL));
}

// Small triangles of a triangle that is tessellated with level n.
uint points_of_level(uint n) { return (3u * n * n) / 2u; }

// Barycentric coordinates of the corners of sub-triangle i of s * s, in units of 1 / s. Rows have 2 (s - row) - 1 sub-triangles from the
// first edge up, every second one upside down.
void sub_triangle(uint i, uint s, out uvec3 a, out uvec3 b, out uvec3 c) {
    uint row = 0u, k = i;
    for (; k >= 2u * (s - row) - 1u; row++) k -= 2u * (s - row) - 1u;
    uint x = k >> 1u;
    if ((k & 1u) == 0u) {
        a = uvec3(s - row - x, x, row);
        b = a + uvec3(-1, 1, 0);
        c = a + uvec3(-1, 0, 1);
    } else {
        a = uvec3(s - row - x - 1u, x + 1u, row);
        b = a + uvec3(-1, 0, 1);
        c = a + uvec3(0, -1, 1);
    }
}

// Barycentric coordinates of the centre of small triangle k of level n, in units of 1 / (9 n), and its share of the area. The tessellator
// makes rings of triangles: ring j has m = n - 2 j segments a side. Its small triangles form strips, with their bases on the ring or on the
// next one inside.
uvec3 small_triangle(uint k, uint n, out float share) {
    uint j = 0u;
    uint m = n;
    for (; m > 1u && k >= 6u * (m - 1u); m -= 2u) {
        k -= 6u * (m - 1u);
        j++;
    }
    share = m > 1u ? 2.0 / float(3u * n * n) : 1.0 / float(n * n);
    if (m <= 1u) return uvec3(3u * n);
    uint strip = 2u * m - 2u;
    uint side = k / strip, t = k - side * strip;
    // Sum of the three corners' positions along the outer edge, and how many of the corners are on the inner edge.
    uint x, q = 1u;
    if (t == 0u) {
        x = 2u;
    } else if (t == strip - 1u) {
        x = 3u * m - 2u;
    } else {
        uint i = (t + 1u) >> 1u;
        bool outer = (t & 1u) != 0u;
        // Diagonals of the quads between two rings lean towards the middle of the side.
        bool leans = 2u * i < m;
        x = 3u * i + (outer ? (leans ? 2u : 1u) : (leans ? 1u : 2u));
        q = outer ? 1u : 2u;
    }
    uint along = 6u * j + 3u * x - q, up = 6u * j + 2u * q;
    uvec3 b = uvec3(9u * n - along - up, along, up);
    return side == 0u ? b : side == 1u ? b.zxy : b.yzx;
}

// Hash of a point that is the same in all frames: from its triangle's corners and draw, its sub-triangle, and its position in that in units
// of 1 / (9 n).
uvec4 point_hash(uvec3 corners, uint draw, uint sub, uvec3 place, uint seed) {
    uvec4 h = pcg4d(uvec4(corners, draw ^ seed));
    return pcg4d(h ^ uvec4(sub, place));
}

// Number in [0, count) from a hash.
uint hashed_index(uint hash, uint count) {
    uint high, low;
    umulExtended(hash, count, high, low);
    return high;
}

// Area of a point after thinning by Russian roulette: points of less than `max_area` survive in proportion to their area and then represent
// `max_area`; 0 for points that are dropped.
float point_area(float area, float max_area, uint hash, bool thin) {
    if (!thin || area >= max_area) return area;
    return float(hash >> 8u) < area / max_area * 16777216.0 ? max_area : 0.0;
}

// Point whose radius is rounded down after `rounding` in [0, 1) of a step of 0.7 % was added: 0.5 is the nearest step.
Point make_point_rounded(vec3 position, vec3 normal, float area, float diagonal, bool double_sided, float rounding) {
    uvec2 n = uvec2(clamp(octahedral(normal) * 511.0 + 512.5, 0.0, 1023.0));
    float radius = sqrt(area / PI);
    uint r = uint(clamp(2047.0 + rounding + 96.0 * log2(radius / diagonal), 0.0, 2047.0));
    return Point(position, n.x | n.y << 10 | r << 20 | (double_sided ? 1u << 31 : 0u));
}

Point make_point(vec3 position, vec3 normal, float area, float diagonal, bool double_sided) {
    return make_point_rounded(position, normal, area, diagonal, double_sided, 0.5);
}

vec3 point_normal(Point p) { return octahedral_inverse((vec2(p.packed & 1023u, p.packed >> 10 & 1023u) - 512.0) / 511.0); }

float point_radius(Point p, float diagonal) { return diagonal * exp2((float(p.packed >> 20 & 2047u) - 2047.0) / 96.0); }

// Empty slot of a buffer: all zeros, which no normal packs to.
bool point_is_empty(Point p) { return p.packed == 0u; }

bool point_is_double_sided(Point p) { return p.packed >> 31 != 0u; }

// Whether a point can occlude a VPL's light, `way` from it: the point is in front of the VPL and faces it, both by at least half a degree.
// Flatter points cover nothing, and only rounding decides about points of the VPL's own surface.
bool point_faces(Point point, vec3 normal, vec3 way, vec3 facing) {
    float before = dot(facing, way), turned = -dot(normal, way);
    if (point_is_double_sided(point)) turned = abs(turned);
    float least = 1e-4 * dot(way, way);
    return before > 0.0 && before * before > least && turned > 0.0 && turned * turned > least;
}

// Growth of a point's radius, since its neighbours are in other maps: `count` VPLs share the points, each point considers `considered` of
// them, could be drawn for `passing` of these, and is drawn for `drawn`.
float point_enlargement(uint count, uint considered, uint passing, uint drawn) {
    return sqrt(float(count) / float(considered) * (float(passing) / float(drawn)));
}
#endif
