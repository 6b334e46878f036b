// VALs that rays have reached.
layout(scalar) readonly buffer Bits { uint at[]; } bits;

bool is_seen(uint cache_number, uint i, uint count) {
    return (bits.at[cache_number * ((count + 31u) / 32u) + i / 32u] >> (i & 31u) & 1u) != 0u;
}
