// Depth interval of single pixels in orthographic maps: the radius. Intervals of a diameter would merge the floors of a building, all of
// which a map sees from above.
#include "visibility/sky-frame.glsl"

layout(scalar) readonly buffer Frames { SkyFrame at[]; } frames;

void put_extent(ivec2 texel, vec2 place, inout Pulled p) {
    ivec2 map = texel / int(MAP_SIZE);
    uint vpl = min(uint(map.y * (imageSize(finer).x / int(MAP_SIZE)) + map.x), uint(frames.at.length()) - 1u);
    p.extent = 2.0 * p.radius / float(MAP_SIZE) * frames.at[vpl].extent;
}
