// Ambient occlusion of the indirect light.
layout(r32f) readonly uniform image2D visible;

float indirect_share(ivec2 pixel) { return imageLoad(visible, pixel).r; }
