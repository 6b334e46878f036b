// All of the indirect light arrives. Each part for "occlusion" defines the share that does.
float indirect_share(ivec2 pixel) { return 1.0; }
