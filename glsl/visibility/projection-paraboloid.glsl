// Maps of the hemisphere that a VPL faces. Each part for "projection" defines the following; `from` is the vector from the VPL to a point.
#include "lib/paraboloid.glsl"

// Line along which the map sees the point, as long as the distance that it keeps.
vec3 sight(vec3 from, vec3 facing) { return from; }

// Whether the point stands in the way of light.
bool is_in_the_way(Point point, vec3 normal, vec3 way, vec3 facing) { return point_faces(point, normal, way, facing); }

// Place in [-1, 1]^2; `w` is the direction to the point, in the map's space.
vec2 place_in_map(uint vpl, vec3 from, vec3 w) { return paraboloid(w); }

// Normal of a plane in the map's space, of which these are the axes.
vec3 plane_in_map(uint vpl, vec3 normal, mat3 axes) { return normal * axes; }

// Radius in that square of a disk of world radius r at distance d, at the angle of this cosine to the axis.
float radius_in_map(uint vpl, float r, float d, float cosine) { return paraboloid_radius(r, d, cosine, DISTORTION); }
