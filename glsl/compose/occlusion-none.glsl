// No occlusion. Each part for "occlusion" defines the share of indirect light that arrives.
float indirect_share(ivec2 pixel) { return 1.0; }
