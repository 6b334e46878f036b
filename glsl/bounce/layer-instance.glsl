// Layers of instances: one for each cluster that sees a part of the scene. Each part for "layer" says which layer a vertex goes to.
layout(scalar) readonly buffer Layers { uint at[]; } layers; // of each part's instances

uint layer_of() { return layers.at[gl_BaseInstance * params.layers + gl_InstanceIndex - gl_BaseInstance]; }
