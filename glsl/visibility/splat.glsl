// Splats (Linke 2016, section 4.4.2): a point is drawn as a square into the maps of the first VPLs that can see it, among those that it is
// tested against.
#include "lib/basis.glsl"
#include "lib/vpl.glsl"
#include "visibility/ism.glsl"
#include "visibility/point.glsl"

layout(constant_id = 1) const uint MAP_SIZE = 64;
layout(constant_id = 2) const bool DISTORTION = true;

#include "part/projection=visibility/projection-paraboloid"

layout(scalar) uniform SplatBlock {
    ivec2 size;      // of the image of all maps
    uint columns;
    uint considered; // VPLs a point is tested against
    uint collected;  // VPLs that a point is drawn for, at most
    float far;       // metres
    float enlarge;
    float largest;   // side of a square, texels
} splat;

layout(scalar) readonly buffer Places { VplPlace at[]; } places;

bool sees(Point point, vec3 normal, VplPlace vpl) {
    vec3 facing = octahedral_snorm16_inverse(vpl.normal);
    return is_in_the_way(point, normal, sight(point.position - vpl.position, facing), facing);
}

// VPLs of `count` from `first` on that see the point, among those considered.
uint passing_vpls(Point point, vec3 normal, uint first, uint count) {
    uint passing = 0u;
    for (uint k = 0u; k < splat.considered; k++) passing += uint(sees(point, normal, places.at[(first + k) % count]));
    return passing;
}

// A square: where it is drawn, its side in texels, its map's corner, the plane of its point in the map's space, and the nearest distance of the
// point's disk. Distances are over `far`. The side may be up to a map's, over what a device draws: it then draws the largest that it has.
struct Square {
    vec4 position;
    float side;
    ivec2 corner;
    vec4 plane;
    float nearest;
};
#include "part/square=visibility/square-center"

Square square_of(Point point, vec3 normal, float radius, uint index) {
    VplPlace vpl = places.at[index];
    vec3 from = point.position - vpl.position;
    mat3 axes = basis_of(octahedral_snorm16_inverse(vpl.normal));
    vec3 way = sight(from, axes[2]);
    float d = length(way);
    vec3 w = way * axes / d;
    float seen_radius = DISTORTION ? radius * sqrt(abs(dot(normal, way)) / d) : radius;
    // Side of a square of the disk's area.
    float side = sqrt(PI) * radius_in_map(index, seen_radius, d, w.z) * (0.5 * float(MAP_SIZE));
    ivec2 corner = map_corner(index, splat.columns, int(MAP_SIZE));
    vec2 texel = vec2(corner) + clamp((place_in_map(index, from, w) * 0.5 + 0.5) * float(MAP_SIZE), vec2(0.01), vec2(float(MAP_SIZE) - 0.01));
    vec4 position = vec4(texel / vec2(splat.size) * 2.0 - 1.0, 1.0 - min(d / splat.far, 1.0), 1.0);
    vec4 plane = vec4(plane_in_map(index, normal, axes), dot(normal, from) / splat.far);
    float nearest = clamp((d - radius) / splat.far, 0.0, 1.0);
    return Square(position, clamp(side, 1.0, splat.largest), corner, plane, nearest);
}
