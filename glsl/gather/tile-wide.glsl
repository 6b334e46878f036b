// Tiles of 16 x 8 pixels of a sample set. Each part for "tile" defines the workgroup, whose invocations have 2 x 2 pixels.
layout(local_size_x = 8, local_size_y = 4) in;
