// Points in holes are left out, and counted.
#include "visibility/masks.glsl"

layout(scalar) buffer Holes { uint count; } holes;

bool is_hole(uint material, uvec3 corners, vec3 weights) {
    if (!lacks(material, corners, weights)) return false;
    atomicAdd(holes.count, 1u);
    return true;
}
