// Chunks of triangles, one a workgroup: src/stages/visibility/triangles.rs.
#include "lib/scene.glsl"

layout(local_size_x = 64) in;

struct Chunk {
    uint first_index;
    uint triangles;
    uint vertex_offset;
    uint draw;
    uint slice; // number among the `slices` that share the chunk's points
    uint slices;
};

layout(scalar) readonly buffer Chunks { Chunk at[]; } chunks;
layout(scalar) readonly buffer Draws { DrawData at[]; } draws;
layout(scalar) readonly buffer Positions { vec3 at[]; } positions;
layout(scalar) readonly buffer Indices { uint at[]; } indices;

// Number of the workgroup; a row of them is no longer than every device allows.
uint group_number() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

shared uvec3 corners[64];
shared vec3 corner[3][64];

// Transforms the invocation's triangle to the world, and returns its area in m^2; 0 beyond the last triangle.
float place_triangle(Chunk chunk) {
    uint lane = gl_LocalInvocationID.x;
    if (lane >= chunk.triangles) return 0.0;
    mat4x3 transform = draws.at[chunk.draw].transform;
    uvec3 ids;
    for (uint i = 0u; i < 3u; i++) {
        ids[i] = indices.at[chunk.first_index + 3u * lane + i] + chunk.vertex_offset;
        corner[i][lane] = transform * vec4(positions.at[ids[i]], 1.0);
    }
    corners[lane] = ids;
    return 0.5 * length(cross(corner[1][lane] - corner[0][lane], corner[2][lane] - corner[0][lane]));
}
