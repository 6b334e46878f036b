// Single pixels have a distance and a radius alone. Each part for "extent" says how deep the depth interval of a texel is that lies at a place of
// the map's disk.
void put_extent(ivec2 texel, vec2 place, inout Pulled p) {
    // The interval is the diameter in the world: the projection's scale undone, and, on the average of all angles, what the disk
    // lost by being seen aslant.
    float scale = DISTORTION ? 6.0 / (1.0 + dot(place, place)) : 4.0;
    p.extent = 2.0 * p.radius * p.depth * scale / float(MAP_SIZE);
}
