// Texels that are all as important. Each part for "importance" defines
//     vec4 importances(ivec3 a, ivec3 b, ivec3 c, ivec3 d, uvec2 size); // of four texels; all invocations of a workgroup call it together
vec4 importances(ivec3 a, ivec3 b, ivec3 c, ivec3 d, uvec2 size) { return vec4(1.0); }
