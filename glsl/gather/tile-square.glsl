// Tiles of 8 x 8 pixels of a sample set. Invocations are in one row, since llvmpipe's lanes are neighbours in x.
layout(local_size_x = 16) in;

uvec2 tile_size() { return uvec2(4u); }
uvec2 place_in_tile() { return uvec2(gl_LocalInvocationID.x % 4u, gl_LocalInvocationID.x / 4u); }
