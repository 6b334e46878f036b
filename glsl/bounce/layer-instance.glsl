// An instance for each cluster that sees a part of the scene. Each part for "layer" defines the layer that the vertex goes to.
layout(scalar) readonly buffer Layers { uint at[]; } layers; // of each part's instances

uint layer_of() { return layers.at[gl_BaseInstance * params.layers + gl_InstanceIndex - gl_BaseInstance]; }
