#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Linked light lists of froxels: VPLs whose hulls reach into a froxel. There is a workgroup a tile and an invocation a slice, which goes
// through the sample set's VPLs in order, so that lists keep it.
#include "gather/shell.glsl"
#include "gather/shell-froxel.glsl"

layout(local_size_x = 32) in;
layout(constant_id = 3) const bool DIFFUSE = true;
layout(constant_id = 4) const bool LOBES = false;

layout(scalar, push_constant) uniform Params {
    uint count;
    uint capacity; // nodes
} params;

layout(scalar) readonly buffer DiffuseShells { uvec2 at[]; } diffuse_shells;
layout(scalar) readonly buffer GlossyShells { uvec2 at[]; } glossy_shells;
layout(scalar) writeonly buffer Heads { uvec2 at[]; } heads; // first nodes of a froxel's diffuse and glossy list
layout(scalar) writeonly buffer Nodes { uvec2 at[]; } nodes;           // VPL, and next node
layout(scalar) buffer Used { uint count; } used;
layout(scalar) buffer Lost { uint count; } lost;

const uint END = 0xffffffffu;

bool reaches(uvec2 shell, uint slice) {
    if ((shell.x | shell.y) == 0u) return false;
    // Without a near side, the eye is inside the hull.
    uint first = shell.x != 0u ? uint(findLSB(shell.x)) : 0u;
    uint last = uint(findMSB(shell.y != 0u ? shell.y : shell.x));
    return slice >= first && slice <= last;
}

// Appends a VPL behind `tail`; the first node becomes the head.
void append(uint index, inout uint head, inout uint tail) {
    uint node = atomicAdd(used.count, 1u);
    if (node >= params.capacity) {
        atomicAdd(lost.count, 1u);
        return;
    }
    nodes.at[node] = uvec2(index, END);
    if (tail == END) head = node;
    else nodes.at[tail].y = node;
    tail = node;
}

void main() {
    uvec2 tiles = (sorted_size() + SHELL_TILE - 1u) / SHELL_TILE;
    uint tile = gl_WorkGroupID.y * tiles.x + gl_WorkGroupID.x, slice = gl_LocalInvocationID.x, set = gl_WorkGroupID.z;
    uint head = END, tail = END, glossy_head = END, glossy_tail = END;
    for (uint index = set; index < params.count; index += SETS) {
        uint at = index * tiles.x * tiles.y + tile;
        if (DIFFUSE && reaches(diffuse_shells.at[at], slice)) append(index, head, tail);
        if (LOBES && reaches(glossy_shells.at[at], slice)) append(index, glossy_head, glossy_tail);
    }
    heads.at[(set * tiles.x * tiles.y + tile) * SHELL_SLICES + slice] = uvec2(head, glossy_head);
}
