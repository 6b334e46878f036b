// VALs that all caches see. Each part for "sight" defines
//     bool is_seen(uint cache_number, uint i, uint count);
// whether a cache sees VAL i of so many.
bool is_seen(uint cache_number, uint i, uint count) { return true; }
