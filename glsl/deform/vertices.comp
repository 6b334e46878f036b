#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Bends vertices by morph targets, then by joints (glTF 2.0, sections 3.7.2.2 and 3.7.3); src/scene/bend/mod.rs has the formula and the
// host's twin. A workgroup bends a run of one mesh's vertices.
#include "lib/packing.glsl"
#include "part/positions=deform/positions-none"
#include "lib/vertex.glsl"

layout(local_size_x = 64) in;

// A run of vertices: src/world/bent.rs.
struct Run {
    uint first;      // in the scene's vertices
    uint count;
    uint within;     // first of them in its mesh
    uint rest;       // first texel of the run
    uint tangents;   // whether a second texel a vertex has its tangent
    uint matrices;   // texel of the skin's first matrix
    uint influences; // first texel of the run
    uint fours;      // texels of influences a vertex; 0 without a skin
    uint targets;    // texel of the mesh's list of targets
};

layout(scalar) readonly buffer Runs { Run at[]; } runs;
layout(scalar) writeonly buffer Vertices { Vertex at[]; } vertices;

// Per vertex: position and packed normal, then packed tangent.
layout(rgba32ui) readonly uniform uimage2D rest;
// Per vertex and four joints: two joints a word, two weights a word.
layout(rgba32ui) readonly uniform uimage2D influences;
// Per target and vertex: displacement of the position, then of the normal.
layout(rgba32ui) readonly uniform uimage2D deltas;
// Three rows a matrix; then lists of targets.
layout(rgba32ui) readonly uniform uimage2D pose;

uvec4 rest_texel(uint i) { return imageLoad(rest, ivec2(i & 4095u, i >> 12)); }
uvec4 influences_texel(uint i) { return imageLoad(influences, ivec2(i & 4095u, i >> 12)); }
vec3 delta_texel(uint i) { return uintBitsToFloat(imageLoad(deltas, ivec2(i & 4095u, i >> 12)).xyz); }
uvec4 pose_texel(uint i) { return imageLoad(pose, ivec2(i & 1023u, i >> 10)); }
vec4 pose_row(uint i) { return uintBitsToFloat(pose_texel(i)); }

void add(inout vec4 rows[3], uint first, uint joint, float weight) {
    uint row = first + 3u * joint;
    rows[0] += weight * pose_row(row);
    rows[1] += weight * pose_row(row + 1u);
    rows[2] += weight * pose_row(row + 2u);
}

void main() {
    uint number = gl_WorkGroupID.y * 32768u + gl_WorkGroupID.x;
    if (number >= uint(runs.at.length())) return;
    Run run = runs.at[number];
    // Lanes past the run's end bend its last vertex once more and store nothing: a software driver loads uniform values once where
    // no lane can be off.
    uint i = min(gl_LocalInvocationID.x, run.count - 1u);
    uvec4 texel = rest_texel(run.rest + i * (1u + run.tangents));
    vec3 position = uintBitsToFloat(texel.xyz);
    vec3 unbent = octahedral_snorm16_inverse(texel.w), normal = unbent;

    uvec4 list = pose_texel(run.targets); // first, count, texels a displacement
    for (uint k = 0u; k < list.y; k++) {
        uvec4 target = pose_texel(list.x + k); // first displacement, weight
        uint at = target.x + (run.within + i) * list.z;
        position += uintBitsToFloat(target.y) * delta_texel(at);
        if (list.z > 1u) normal += uintBitsToFloat(target.y) * delta_texel(at + 1u);
    }

    vec3 tangent = vec3(0.0);
    uint handedness = 0u;
    if (run.tangents != 0u) {
        uint word = rest_texel(run.rest + 2u * i + 1u).x;
        tangent = tangent_inverse(word).xyz;
        handedness = word & 0x80000000u;
    }
    if (run.fours > 0u) {
        vec4 rows[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
        for (uint four = 0u; four < run.fours; four++) {
            uvec4 packed = influences_texel(run.influences + i * run.fours + four);
            vec2 low = unpackUnorm2x16(packed.z), high = unpackUnorm2x16(packed.w);
            add(rows, run.matrices, packed.x & 0xffffu, low.x);
            add(rows, run.matrices, packed.x >> 16, low.y);
            add(rows, run.matrices, packed.y & 0xffffu, high.x);
            add(rows, run.matrices, packed.y >> 16, high.y);
        }
        position = vec3(dot(rows[0].xyz, position), dot(rows[1].xyz, position), dot(rows[2].xyz, position))
            + vec3(rows[0].w, rows[1].w, rows[2].w);
        tangent = vec3(dot(rows[0].xyz, tangent), dot(rows[1].xyz, tangent), dot(rows[2].xyz, tangent));
        // Rows of the cofactor matrix; its sign is that of the determinant.
        vec3 x = cross(rows[1].xyz, rows[2].xyz), y = cross(rows[2].xyz, rows[0].xyz), z = cross(rows[0].xyz, rows[1].xyz);
        normal = vec3(dot(x, normal), dot(y, normal), dot(z, normal)) * (dot(rows[0].xyz, x) < 0.0 ? -1.0 : 1.0);
    }
    // Scaled first, since the cofactors of a small mesh are tiny.
    float most = max(max(abs(normal.x), abs(normal.y)), abs(normal.z));
    normal = most > 0.0 ? normal / most : unbent;

    if (gl_LocalInvocationID.x < run.count) {
        vertices.at[run.first + i].position = position;
        vertices.at[run.first + i].normal = octahedral_snorm16(normal);
        keep_position(run.first + i, position);
        if (run.tangents != 0u) {
            float size = max(max(abs(tangent.x), abs(tangent.y)), abs(tangent.z));
            if (size > 0.0) vertices.at[run.first + i].tangent = packed_tangent(tangent / size) | handedness;
        }
    }
}
