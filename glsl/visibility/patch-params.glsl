// Push constants of the passes that tessellate: src/stages/visibility/points.rs.
#include "visibility/sizes.glsl"

layout(scalar, push_constant) uniform Params {
    float diagonal; // of the scene's bounds, metres
    uint partitions;
    uint first;     // partition of the buffer's first points
    uint held;      // partitions in the buffer
    uint capacity;  // points of a partition
    uint seed;
    uint chunk;     // of the first workgroup
    uint end;       // chunk after the last
} params;
