#ifndef TILT_GLSL
#define TILT_GLSL
// Tilt of a surface, seen by a map: its normal's components along the map's two axes there. The projection is conformal, so these axes are
// perpendicular; the normal's rest points to the VPL.

// Tilt of a normal that is seen in the direction w, at the place p of the disk.
vec2 tilt_of(vec3 normal, vec3 w, vec2 p) {
    float sum = 1.0 + dot(p, p);
    vec3 right = vec3(sum - 2.0 * p.x * p.x, -2.0 * p.x * p.y, -2.0 * p.x) / sum;
    vec3 up = vec3(-2.0 * p.x * p.y, sum - 2.0 * p.y * p.y, -2.0 * p.y) / sum;
    // Double-sided: the normal is flipped to face the VPL.
    return vec2(dot(normal, right), dot(normal, up)) * (dot(normal, w) > 0.0 ? -1.0 : 1.0);
}

// Never all ones, which mean empty.
uint pack_tilt(vec2 tilt) { return packUnorm2x16(clamp(tilt, -0.999, 0.999) * 0.5 + 0.5); }
vec2 unpack_tilt(uint word) { return unpackUnorm2x16(word) * 2.0 - 1.0; }

// Cosine between the normal and the direction to the VPL, at least 0.05.
float facing_of(vec2 tilt) { return sqrt(max(1.0 - dot(tilt, tilt), 0.0025)); }
#endif
