// Importance of the chains' proposals, worked out for them alone. Each part for "proposed" defines
//     float importance_of(uint chain, uint step, ivec3 texel);
layout(scalar) readonly buffer Proposed { float at[]; } proposed;

float importance_of(uint chain, uint step, ivec3 texel) { return proposed.at[step * params.count + chain]; }
