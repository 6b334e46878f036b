// Layer by instance: one for each cluster that sees a part of the scene. Each part for "layer" defines the layer of the vertex.
layout(scalar) readonly buffer Layers { uint at[]; } layers; // cluster of each instance of a part

uint layer_of() { return layers.at[gl_BaseInstance * params.layers + gl_InstanceIndex - gl_BaseInstance]; }
