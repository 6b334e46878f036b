// Tiles of 16 x 8 pixels of a sample set. Each part for "tile" defines the workgroup, whose invocations have 2 x 2 pixels, and their places.
layout(local_size_x = 8, local_size_y = 4) in;

uvec2 tile_size() { return uvec2(8u, 4u); }
uvec2 place_in_tile() { return gl_LocalInvocationID.xy; }
