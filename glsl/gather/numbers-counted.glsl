// Light lists that are counted.
const bool STATISTICS = true;

layout(rgba32f) writeonly uniform image2D numbers;

void store_numbers(ivec2 pixel, vec4 of_pixel) { imageStore(numbers, pixel, of_pixel); }
