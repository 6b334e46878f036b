// Lanes of a subgroup that fetch for one another: active ones, side by side. A subgroup need not be full. A workgroup may end within one,
// and a driver may report a larger size than it executes. So the shader asks by a ballot which lanes are active.
struct Lanes {
    uint first; // the lowest of them
    uint count; // a power of two up to 32: a round of fetches is within one word of bits
    uint mine;  // this lane's place among them; `count` or more if it only receives
};

// The 32 bits of a ballot from lane `first` on.
uint ballot_from(uvec4 ballot, uint first) {
    uint word = first / 32u, shift = first % 32u;
    return ballot[word] >> shift | (shift > 0u && word < 3u ? ballot[word + 1u] << (32u - shift) : 0u);
}

// The lanes that fetch, of a ballot of active ones, as lane `me` sees them.
Lanes lanes_of(uvec4 active_lanes, uint me) {
    uint word = active_lanes.x != 0u ? 0u : active_lanes.y != 0u ? 1u : active_lanes.z != 0u ? 2u : 3u;
    uint first = word * 32u + uint(findLSB(active_lanes[word])), run = ballot_from(active_lanes, first);
    return Lanes(first, run == ~0u ? 32u : 1u << findMSB(findLSB(~run)), me - first);
}

// The lanes that fetch in this subgroup. The whole workgroup calls it.
Lanes lanes_of_subgroup() { return lanes_of(subgroupBallot(true), gl_SubgroupInvocationID); }

// Lane at place `i`; the last one if `i` is beyond them.
uint lane_at(Lanes lanes, uint i) { return lanes.first + min(i, lanes.count - 1u); }

// A bit for each of the lanes.
uint bits_of(Lanes lanes) { return ~0u >> (32u - lanes.count); }
