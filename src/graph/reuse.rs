//! Passes that need not run again: their inputs are those of the frame before, so that their outputs still hold.
//!
//! A pass is known by a key: its shader, constants, parameters and targets, and the versions of what it reads. A version is the key of the
//! pass that wrote it, or the hash of what the host uploaded. Resources are not aliased, so an output stays in memory until its pass runs
//! again.

use super::pass::{Pass, Work};
use super::record::{Placed, accesses};
use super::{Graph, Source};
use crate::gpu::Accesses;
use blake3::{Hash, Hasher};
use std::collections::HashMap;
use std::fmt::Debug;
use std::io::Write;

/// Whether a frame takes over results of the frame before it in its sequence. The number stands for everything that the host may have
/// changed in buffers and images that outlive the frame: results are taken over only while it stays the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reuse {
    /// Every pass runs, and nothing is kept in mind.
    #[default]
    Never,
    /// Every pass runs, and a later frame may take over its results.
    Remember(u64),
    /// Only passes run whose inputs have changed, or whose results were overwritten. The frame's results are the same bytes; its times are
    /// those of the passes that ran.
    Apply(u64),
}

/// Keys of the passes of a frame, for the next one.
#[derive(Debug, Clone, Default)]
pub(super) struct Memory {
    number: u64,
    /// `None` for a pass whose results can never be taken over.
    keys: HashMap<&'static str, Option<Hash>>,
}

impl Reuse {
    fn number(self) -> Option<u64> {
        match self {
            Self::Never => None,
            Self::Remember(number) | Self::Apply(number) => Some(number),
        }
    }
}

/// Which passes of a frame run, and what to keep in mind of them. Passes in `always` run in any case.
pub(super) fn plan(
    graph: &Graph,
    placed: &Placed,
    reuse: Reuse,
    before: Option<&Memory>,
    always: &[String],
) -> (Vec<bool>, Option<Memory>) {
    let Some(number) = reuse.number() else { return (vec![true; graph.passes.len()], None) };
    let keys = keys(graph, placed);
    let before = before.filter(|before| matches!(reuse, Reuse::Apply(_)) && before.number == number);
    let holds = |pass: &Pass, key: &Option<Hash>| {
        let known = before.and_then(|before| before.keys.get(pass.name));
        key.is_some() && known == Some(key) && !always.iter().any(|name| name == pass.name)
    };
    let mut runs: Vec<bool> = graph.passes.iter().zip(&keys).map(|(pass, key)| !holds(pass, key)).collect();
    spread(graph, &mut runs);
    let keys = graph.passes.iter().map(|pass| pass.name).zip(keys).collect();
    (runs, Some(Memory { number, keys }))
}

/// Lets passes run that others need: a resource is written anew by all of its passes or by none, and a pass that reads a resource between
/// two of its writers needs both.
fn spread(graph: &Graph, runs: &mut [bool]) {
    let uses: Vec<Vec<(usize, bool, bool)>> = graph.passes.iter().map(uses).collect();
    let mut last_writer: HashMap<usize, usize> = HashMap::new();
    for (pass, uses) in uses.iter().enumerate() {
        last_writer.extend(uses.iter().filter(|(.., writes)| *writes).map(|(resource, ..)| (*resource, pass)));
    }
    loop {
        let mut anew: Vec<usize> = Vec::new();
        for (pass, uses) in uses.iter().enumerate().filter(|(pass, _)| runs[*pass]) {
            for (resource, reads, writes) in uses {
                let is_overwritten = *reads && last_writer.get(resource).is_some_and(|last| *last > pass);
                if *writes || is_overwritten {
                    anew.push(*resource);
                }
            }
        }
        let mut changed = false;
        for (pass, uses) in uses.iter().enumerate() {
            if !runs[pass] && uses.iter().any(|(resource, _, writes)| *writes && anew.contains(resource)) {
                (runs[pass], changed) = (true, true);
            }
        }
        if !changed {
            return;
        }
    }
}

/// Resources of a pass: index, whether it reads it, whether it writes it.
fn uses(pass: &Pass) -> Vec<(usize, bool, bool)> {
    let all = accesses(pass).into_iter();
    all.map(|access| (access.resource, access.accesses.intersects(!Accesses::WRITES), access.accesses.intersects(Accesses::WRITES)))
        .collect()
}

fn keys(graph: &Graph, placed: &Placed) -> Vec<Option<Hash>> {
    // `None` if nothing is known of the contents.
    let is_zeroed = |index: usize| placed.buffers.get(&index).is_some_and(|id| placed.zeroed.contains(id));
    let versions = graph.slots.iter().enumerate().map(|(index, slot)| version(&slot.source, is_zeroed(index)));
    let mut versions: Vec<Option<Hash>> = versions.collect();
    // What a pass may write outlives the frame, and is not what the frame before began with.
    for pass in &graph.passes {
        for (resource, _, writes) in uses(pass) {
            if writes && matches!(graph.slots[resource].source, Source::KeptBuffer(_) | Source::KeptImage(_)) {
                versions[resource] = None;
            }
        }
    }
    let mut keys = Vec::with_capacity(graph.passes.len());
    for pass in &graph.passes {
        let key = key(pass, placed, &versions);
        for (resource, _, _) in uses(pass).into_iter().filter(|(.., writes)| *writes) {
            versions[resource] = key.filter(|_| versions[resource].is_some()).map(|key| {
                let mut hasher = Hasher::new();
                hasher.update(key.as_bytes()).update(&(resource as u64).to_le_bytes());
                hasher.finalize()
            });
        }
        keys.push(key);
    }
    keys
}

/// What a resource holds when the frame begins.
fn version(source: &Source, is_zeroed: bool) -> Option<Hash> {
    match source {
        Source::Uploaded(bytes) => Some(blake3::hash(bytes)),
        Source::History if !is_zeroed => None,
        // Undefined, zeros, or what the number of `Reuse` stands for.
        _ => Some(blake3::hash(b"")),
    }
}

fn key(pass: &Pass, placed: &Placed, versions: &[Option<Hash>]) -> Option<Hash> {
    let mut hasher = Hasher::new();
    say(&mut hasher, &(pass.name, pass.shader, &pass.parts, &pass.constants));
    for used in &pass.uses {
        say(&mut hasher, &(used.binding, used.access, used.sampler));
    }
    if let Some((_, bytes)) = &pass.params {
        hasher.update(bytes);
    }
    match &pass.work {
        Work::Compute(extent) => say(&mut hasher, extent),
        raster @ Work::Raster { .. } => say(&mut hasher, raster),
    }
    for (resource, ..) in uses(pass) {
        hasher.update(versions[resource]?.as_bytes());
        say(&mut hasher, &(placed.images.get(&resource), placed.buffers.get(&resource)));
    }
    Some(hasher.finalize())
}

fn say(hasher: &mut Hasher, what: &impl Debug) {
    // A hasher takes everything.
    let _ = write!(hasher, "{what:?};");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::Format;

    fn empty() -> Placed {
        Placed { images: HashMap::new(), buffers: HashMap::new(), zeroed: Vec::new() }
    }

    /// Passes that run of a frame whose second upload is `view`, after one with 1.
    fn ran(describe: impl Fn(&mut Graph, u32)) -> Vec<&'static str> {
        let [mut first, mut second] = [Graph::new(), Graph::new()];
        describe(&mut first, 1);
        describe(&mut second, 2);
        let (all, memory) = plan(&first, &empty(), Reuse::Remember(7), None, &[]);
        assert!(all.iter().all(|runs| *runs));
        let (other, _) = plan(&second, &empty(), Reuse::Apply(8), memory.as_ref(), &[]);
        assert!(other.iter().all(|runs| *runs), "another number takes nothing over");
        let (runs, _) = plan(&second, &empty(), Reuse::Apply(7), memory.as_ref(), &[]);
        second.pass_names().zip(runs).filter(|(_, runs)| *runs).map(|(pass, _)| pass).collect()
    }

    #[test]
    fn only_what_hangs_on_a_change_runs_again() {
        let passes = ran(|g, view| {
            let (lights, view) = (g.upload("lights", &[5u32]), g.upload("view", &[view]));
            let (map, picture, sum) = (
                g.image("map", Format::R32Float, [1, 1]),
                g.image("picture", Format::R32Float, [1, 1]),
                g.image("sum", Format::R32Float, [1, 1]),
            );
            g.compute("map").reads("lights", lights).writes("map", map).dispatch([1, 1, 1]);
            g.compute("picture").reads("view", view).writes("picture", picture).dispatch([1, 1, 1]);
            g.compute("sum").reads("picture", picture).reads("map", map).writes("sum", sum).dispatch([1, 1, 1]);
        });
        assert_eq!(passes, ["picture", "sum"]);
    }

    #[test]
    fn all_writers_of_a_resource_run_or_none() {
        let passes = ran(|g, view| {
            let (lights, view, sums) = (g.upload("lights", &[5u32]), g.upload("view", &[view]), g.zeroed::<u32>("sums", 4));
            g.compute("first").reads("lights", lights).updates("sums", sums).dispatch([1, 1, 1]);
            g.compute("second").reads("view", view).updates("sums", sums).dispatch([1, 1, 1]);
        });
        assert_eq!(passes, ["first", "second"]);
    }

    #[test]
    fn what_was_overwritten_since_is_made_again_for_its_reader() {
        let passes = ran(|g, view| {
            let (lights, view, map) = (g.upload("lights", &[5u32]), g.upload("view", &[view]), g.buffer::<u32>("map", 4));
            let [a, b] = ["a", "b"].map(|name| g.buffer::<u32>(name, 1));
            g.compute("writes").reads("lights", lights).writes("map", map).dispatch([1, 1, 1]);
            g.compute("reads").reads("view", view).reads("map", map).writes("a", a).dispatch([1, 1, 1]);
            g.compute("overwrites").reads("lights", lights).writes("map", map).dispatch([2, 1, 1]);
            g.compute("apart").reads("lights", lights).writes("b", b).dispatch([1, 1, 1]);
        });
        assert_eq!(passes, ["writes", "reads", "overwrites"]);
    }

    #[test]
    fn history_that_goes_on_is_never_taken_over() {
        let passes = ran(|g, _| {
            let (lights, kept) = (g.upload("lights", &[5u32]), g.history::<u32>("kept", 4));
            g.compute("blend").reads("lights", lights).updates("kept", kept).dispatch([1, 1, 1]);
        });
        assert_eq!(passes, ["blend"]);
    }
}
