// Depth interval of single pixels without normals. Each part for "extent" sets the depth interval of a texel at a place of the map's disk.
layout(constant_id = 4) const float INTERVAL = 1.5; // in diameters

void put_extent(ivec2 texel, vec2 place, inout Pulled p) {
    // The diameter is that in the world: the projection's scale is undone. Foreshortening is, too, by an interval of 1.5: its mean over all
    // angles is two thirds.
    float scale = DISTORTION ? 4.0 * INTERVAL / (1.0 + dot(place, place)) : 4.0;
    p.extent = 2.0 * p.radius * p.depth * scale / float(MAP_SIZE);
}
