// Light lists that are not counted. Each part for "numbers" defines
//     const bool STATISTICS;
//     void store_numbers(ivec2 pixel, vec4 of_pixel);
// It stores the numbers of VPLs on a pixel's lists, and of those that shine there: diffuse ones, then glossy ones.
const bool STATISTICS = false;

void store_numbers(ivec2 pixel, vec4 of_pixel) {}
