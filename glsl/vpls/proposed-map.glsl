// Importance of the chains' proposals, from the map of all texels.
uniform sampler2DArray importance;

float importance_of(uint chain, uint step, ivec3 texel) { return texelFetch(importance, texel, 0).r; }
