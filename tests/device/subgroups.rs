//! Lanes of a subgroup that fetch for one another, in subgroups that are full and in those that are not.

use crate::common::*;
use manylight::graph::{Engine, Execution, Graph, Library};
use std::collections::BTreeMap;

const HEAD: &str = "#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_basic : require
#extension GL_KHR_shader_subgroup_ballot : require
#include \"lib/subgroup.glsl\"
";

/// Sums numbers as the gathers sum VPLs: all of them, and those that a ballot lists.
const SUMS: &str = "layout(local_size_x = ACROSS, local_size_y = DOWN) in;
layout(scalar) readonly buffer Numbers { float at[]; } numbers;
layout(scalar) writeonly buffer Sums { uint at[]; } sums;
void main() {
    Lanes lanes = lanes_of_subgroup();
    uint count = uint(numbers.at.length());
    float all = 0.0, listed = 0.0;
    for (uint start = 0u; start < count; start += lanes.count) {
        bool there = start + lanes.mine < count && lanes.mine < lanes.count;
        float mine = there ? numbers.at[start + lanes.mine] : 0.0;
        uint list = ballot_from(subgroupBallot(there && mine > 0.5), lanes.first), bits = bits_of(lanes);
        for (uint i = 0u; i < lanes.count; i += 4u) {
            for (uint k = i; k < i + 4u; k++) all += subgroupBroadcast(mine, lane_at(lanes, k)) * float((bits >> k) & 1u);
        }
        for (; list != 0u; list &= list - 1u) listed += subgroupBroadcast(mine, lane_at(lanes, uint(findLSB(list))));
    }
    sums.at[3u * gl_LocalInvocationIndex] = floatBitsToUint(all);
    sums.at[3u * gl_LocalInvocationIndex + 1u] = floatBitsToUint(listed);
    sums.at[3u * gl_LocalInvocationIndex + 2u] = lanes.count;
}
";

/// The lanes that fetch, of ballots: the first, their number, and the place of lane 100.
const OF_BALLOTS: &str = "layout(local_size_x = 1) in;
layout(scalar) readonly buffer Ballots { uint at[]; } ballots;
layout(scalar) writeonly buffer Found { uint at[]; } found;
void main() {
    uint me = gl_GlobalInvocationID.x;
    Lanes lanes = lanes_of(uvec4(ballots.at[4u * me], ballots.at[4u * me + 1u], ballots.at[4u * me + 2u], ballots.at[4u * me + 3u]), 100u);
    found.at[3u * me] = lanes.first;
    found.at[3u * me + 1u] = lanes.count;
    found.at[3u * me + 2u] = lanes.mine;
}
";

/// Runs a shader that reads `input` and writes three words for each of `outputs`.
fn run(body: &str, bindings: [&'static str; 2], input: &[u32], outputs: u32, groups: u32) -> Vec<[u32; 3]> {
    let subgroup = concat!(env!("CARGO_MANIFEST_DIR"), "/glsl/lib/subgroup.glsl");
    let sources = BTreeMap::from([
        ("lib/subgroup.glsl".to_owned(), std::fs::read_to_string(subgroup).unwrap()),
        ("test/lanes.comp".to_owned(), format!("{HEAD}{body}")),
    ]);
    let mut engine = Engine::new(gpu(), Library::from_sources(sources));
    let mut g = Graph::new();
    let from = g.upload("test/from", input);
    let to = g.buffer::<u32>("test/to", 3 * outputs);
    g.compute("test/lanes").reads(bindings[0], from).writes(bindings[1], to).dispatch_groups([groups, 1, 1]);
    let read = g.read_back(to);
    let outcome = engine.execute(&g, &Execution::default()).unwrap_or_else(|error| panic!("{error:#}"));
    let words: Vec<u32> = words(outcome.bytes(read)).collect();
    finish(&engine.gpu);
    words.chunks_exact(3).map(|w| [w[0], w[1], w[2]]).collect()
}

#[test]
fn lanes_share_what_they_fetch_in_full_subgroups_and_in_others() {
    let numbers: Vec<f32> = random_numbers(101).iter().map(|u| u[0]).collect();
    let sum = |least: f32| numbers.iter().filter(|n| **n > least).fold(0.0, |sum, n| sum + n);
    let bits: Vec<u32> = numbers.iter().map(|n| n.to_bits()).collect();
    for [across, down] in [[8, 4], [8, 8], [1, 1], [2, 1], [3, 1], [5, 5], [12, 1], [31, 1], [33, 1], [127, 1]] {
        let body = SUMS.replace("ACROSS", &across.to_string()).replace("DOWN", &down.to_string());
        for found in run(&body, ["numbers", "sums"], &bits, across * down, 1) {
            let [all, listed, lanes] = found;
            let what = format!("{across} x {down} invocations, {lanes} lanes fetch");
            assert_eq!([all, listed].map(f32::from_bits), [sum(-1.0), sum(0.5)], "{what}");
            assert!(lanes.is_power_of_two() && lanes <= across * down, "{what}");
            // Fewer would be slow, and not wrong.
            assert!(lanes >= 4 || (across * down) % 4 > 0, "{what}");
        }
    }
}

#[test]
fn the_first_active_lanes_side_by_side_fetch() {
    let cases = [
        ([0xff, 0, 0, 0], [0, 8]),
        ([!0, 0, 0, 0], [0, 32]),
        ([!0; 4], [0, 32]),
        ([1, 0, 0, 0], [0, 1]),
        ([0xfff, 0, 0, 0], [0, 8]),
        ([0xfff0, 0, 0, 0], [4, 8]),
        ([0xffff_fff0, 0xf, 0, 0], [4, 32]),
        ([0xf000_0000, 0x3, 0, 0], [28, 4]),
        ([0, 0, 0xff00_0000, 0xff], [88, 16]),
        ([0, 0, 0, 0x8000_0000], [127, 1]),
        ([0b1011_0000, 0, 0, 0], [4, 2]),
    ];
    let ballots: Vec<u32> = cases.iter().flat_map(|(ballot, _)| *ballot).collect();
    let found = run(OF_BALLOTS, ["ballots", "found"], &ballots, cases.len() as u32, cases.len() as u32);
    for ((ballot, [first, count]), lanes) in cases.iter().zip(found) {
        assert_eq!(lanes, [*first, *count, 100u32.wrapping_sub(*first)], "{ballot:x?}");
    }
}
