// Tiles of 8 x 8 pixels of a sample set.
layout(local_size_x = 4, local_size_y = 4) in;
