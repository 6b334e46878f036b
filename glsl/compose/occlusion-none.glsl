// No ambient occlusion. Each part for "occlusion" defines the share of the indirect light that arrives.
float indirect_share(ivec2 pixel) { return 1.0; }
