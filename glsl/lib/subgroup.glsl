// Lanes of a subgroup that fetch for one another. A subgroup need not be full: a workgroup may end within one, and a driver may tell a
// larger size than it runs. So the shader asks which lanes run, and goes by a row of them.
struct Lanes {
    uint first; // lane that begins the row
    uint count; // its length, a power of two up to 32: what a round fetches is within one word of bits
    uint mine;  // this lane's place in the row; `count` or more if it only receives
};

// The 32 bits of a ballot from lane `first` on.
uint ballot_from(uvec4 ballot, uint first) {
    uint word = first / 32u, shift = first % 32u;
    return ballot[word] >> shift | (shift > 0u && word < 3u ? ballot[word + 1u] << (32u - shift) : 0u);
}

// The row of lane `me` among the lanes that run.
Lanes row_of(uvec4 running, uint me) {
    uint word = running.x != 0u ? 0u : running.y != 0u ? 1u : running.z != 0u ? 2u : 3u;
    uint first = word * 32u + uint(findLSB(running[word])), row = ballot_from(running, first);
    return Lanes(first, row == ~0u ? 32u : 1u << findMSB(findLSB(~row)), me - first);
}

// The row of this subgroup. The whole workgroup calls it.
Lanes lanes_of_subgroup() { return row_of(subgroupBallot(true), gl_SubgroupInvocationID); }

// Lane of place `i`; the last one's beyond the row.
uint lane_at(Lanes lanes, uint i) { return lanes.first + min(i, lanes.count - 1u); }

// A bit for each lane of the row.
uint bits_of(Lanes lanes) { return ~0u >> (32u - lanes.count); }
