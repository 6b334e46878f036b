// Bounds of 64 caches that follow each other.
struct CacheTile {
    vec3 low;
    vec3 high;
};
