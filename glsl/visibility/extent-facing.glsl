// Single pixels without normals. Each part for "extent" sets the depth interval of a texel, which lies at a place of the map's disk.
void put_extent(ivec2 texel, vec2 place, inout Pulled p) {
    // The interval is the diameter in the world. The projection's scale is undone, and, on the average of all angles, the foreshortening.
    float scale = DISTORTION ? 6.0 / (1.0 + dot(place, place)) : 4.0;
    p.extent = 2.0 * p.radius * p.depth * scale / float(MAP_SIZE);
}
