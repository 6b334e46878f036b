// Depth interval of single pixels without normals. Each part for "extent" sets the depth interval of a texel at a place of the map's disk.
void put_extent(ivec2 texel, vec2 place, inout Pulled p) {
    // The interval is the diameter in the world: the projection's scale is undone, and the mean foreshortening over all angles.
    float scale = DISTORTION ? 6.0 / (1.0 + dot(place, place)) : 4.0;
    p.extent = 2.0 * p.radius * p.depth * scale / float(MAP_SIZE);
}
