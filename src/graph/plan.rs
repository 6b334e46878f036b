//! Planner of barriers between passes, from the passes' accesses: pure data, no device.

use crate::gpu::{Accesses, Barrier, Stages};

/// Access of one pass to one resource.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Access {
    pub resource: usize,
    pub stages: Stages,
    pub accesses: Accesses,
}

/// State of a resource at some point of the frame.
#[derive(Debug, Clone)]
struct State {
    write_stages: Stages,
    write_accesses: Accesses,
    /// Stages and accesses that the last write is visible to.
    visible: Vec<(Stages, Accesses)>,
    /// Stages that have read since the last write.
    read_stages: Stages,
    /// Stages that already wait for all of these reads.
    after_reads: Stages,
}

impl Default for State {
    fn default() -> Self {
        Self {
            write_stages: Stages::empty(),
            write_accesses: Accesses::empty(),
            visible: Vec::new(),
            read_stages: Stages::empty(),
            after_reads: Stages::empty(),
        }
    }
}

/// Barrier before each pass: at most one, and none if no hazard needs it. Barriers are global, so one that a resource needs also counts for
/// all other resources whose accesses it covers. Before the first pass everything is idle and visible.
pub fn plan(passes: &[Vec<Access>]) -> Vec<Option<Barrier>> {
    let count = passes.iter().flatten().map(|access| access.resource + 1).max().unwrap_or(0);
    let mut states = vec![State::default(); count];
    passes.iter().map(|accesses| step(&mut states, accesses)).collect()
}

fn step(states: &mut [State], accesses: &[Access]) -> Option<Barrier> {
    let none = Barrier { from: Stages::empty(), written: Accesses::empty(), to: Stages::empty(), needed: Accesses::empty() };
    let mut barrier = none;
    for access in accesses {
        let state = &states[access.resource];
        let seen = |(stages, kinds): &(Stages, Accesses)| stages.contains(access.stages) && kinds.contains(access.accesses);
        // Read after write, and write after write: needs memory visibility.
        if !state.write_stages.is_empty() && !state.visible.iter().any(seen) {
            barrier.from |= state.write_stages;
            barrier.written |= state.write_accesses;
            barrier.to |= access.stages;
            barrier.needed |= access.accesses;
        }
        // Write after read: needs an execution dependency alone.
        let writes = access.accesses.intersects(Accesses::WRITES);
        if writes && !state.read_stages.is_empty() && !state.after_reads.contains(access.stages) {
            barrier.from |= state.read_stages;
            barrier.to |= access.stages;
        }
    }
    if barrier != none {
        for state in states.iter_mut() {
            let covered = barrier.from.contains(state.write_stages) && barrier.written.contains(state.write_accesses);
            if !state.write_stages.is_empty() && covered {
                state.visible.push((barrier.to, barrier.needed));
            }
            if !state.read_stages.is_empty() && barrier.from.contains(state.read_stages) {
                state.after_reads |= barrier.to;
            }
        }
    }
    for access in accesses {
        let state = &mut states[access.resource];
        let writes = access.accesses & Accesses::WRITES;
        if writes.is_empty() {
            state.read_stages |= access.stages;
            state.after_reads = Stages::empty();
        } else {
            *state = State { write_stages: access.stages, write_accesses: writes, ..State::default() };
        }
    }
    (barrier != none).then_some(barrier)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reads(resource: usize, stages: Stages) -> Access {
        Access { resource, stages, accesses: Accesses::SHADER_READ }
    }

    fn writes(resource: usize, stages: Stages) -> Access {
        Access { resource, stages, accesses: Accesses::SHADER_WRITE }
    }

    fn updates(resource: usize, stages: Stages) -> Access {
        Access { resource, stages, accesses: Accesses::SHADER_READ | Accesses::SHADER_WRITE }
    }

    const COMPUTE: Stages = Stages::COMPUTE;

    #[test]
    fn the_first_pass_and_independent_passes_need_no_barrier() {
        assert_eq!(plan(&[vec![writes(0, COMPUTE)], vec![writes(1, COMPUTE)], vec![writes(2, COMPUTE)]]), vec![None, None, None]);
    }

    #[test]
    fn a_read_after_a_write_waits_for_it_and_sees_it() {
        let barriers = plan(&[vec![writes(0, COMPUTE)], vec![reads(0, Stages::FRAGMENT)]]);
        let expected = Barrier { from: COMPUTE, written: Accesses::SHADER_WRITE, to: Stages::FRAGMENT, needed: Accesses::SHADER_READ };
        assert_eq!(barriers, vec![None, Some(expected)]);
    }

    #[test]
    fn a_second_read_of_the_same_kind_needs_nothing_more() {
        let barriers = plan(&[vec![writes(0, COMPUTE)], vec![reads(0, COMPUTE)], vec![reads(0, COMPUTE)]]);
        assert!(barriers[1].is_some() && barriers[2].is_none());
    }

    #[test]
    fn a_second_read_in_another_stage_needs_its_own() {
        let barriers = plan(&[vec![writes(0, COMPUTE)], vec![reads(0, COMPUTE)], vec![reads(0, Stages::FRAGMENT)]]);
        assert_eq!(barriers[2].map(|b| (b.from, b.to)), Some((COMPUTE, Stages::FRAGMENT)));
    }

    #[test]
    fn a_write_after_reads_waits_for_all_of_them_without_flushing() {
        let barriers = plan(&[vec![reads(0, Stages::FRAGMENT)], vec![reads(0, COMPUTE)], vec![writes(0, COMPUTE)]]);
        let barrier = barriers[2].unwrap();
        assert_eq!(barrier.from, Stages::FRAGMENT | COMPUTE);
        assert!(barrier.written.is_empty());
    }

    #[test]
    fn a_write_after_a_write_is_ordered() {
        let barriers = plan(&[vec![writes(0, COMPUTE)], vec![writes(0, COMPUTE)]]);
        assert_eq!(barriers[1].map(|b| (b.written, b.needed)), Some((Accesses::SHADER_WRITE, Accesses::SHADER_WRITE)));
    }

    #[test]
    fn an_update_waits_for_the_update_before_it() {
        let barriers = plan(&[vec![updates(0, COMPUTE)], vec![updates(0, COMPUTE)], vec![updates(0, COMPUTE)]]);
        assert!(barriers[1].is_some() && barriers[2].is_some());
    }

    #[test]
    fn attachments_are_seen_by_shaders_only_after_a_barrier() {
        let draw = Access { resource: 0, stages: Stages::ATTACHMENT, accesses: Accesses::ATTACHMENT_READ | Accesses::ATTACHMENT_WRITE };
        let barriers = plan(&[vec![draw], vec![reads(0, COMPUTE)], vec![draw]]);
        let first = barriers[1].unwrap();
        assert_eq!((first.from, first.written, first.to), (Stages::ATTACHMENT, Accesses::ATTACHMENT_WRITE, COMPUTE));
        let second = barriers[2].unwrap();
        assert!(second.from.contains(COMPUTE) && second.to.contains(Stages::ATTACHMENT));
    }

    #[test]
    fn vertices_that_a_pass_makes_are_seen_by_draws_and_by_shaders_and_made_again_after_them() {
        let draws = Access { resource: 0, stages: Stages::VERTEX_INPUT, accesses: Accesses::VERTEX_READ };
        let barriers = plan(&[vec![writes(0, COMPUTE)], vec![draws], vec![draws], vec![reads(0, COMPUTE)], vec![writes(0, COMPUTE)]]);
        let seen = |stages, needed| Barrier { from: COMPUTE, written: Accesses::SHADER_WRITE, to: stages, needed };
        assert_eq!(barriers[1], Some(seen(Stages::VERTEX_INPUT, Accesses::VERTEX_READ)));
        assert_eq!(barriers[2], None);
        assert_eq!(barriers[3], Some(seen(COMPUTE, Accesses::SHADER_READ)));
        let again = barriers[4].unwrap();
        assert_eq!((again.from, again.to), (Stages::VERTEX_INPUT | COMPUTE, COMPUTE));
    }

    #[test]
    fn one_barrier_serves_every_resource_that_it_covers() {
        let barriers = plan(&[
            vec![writes(0, COMPUTE), writes(1, COMPUTE)],
            vec![reads(0, COMPUTE)],
            vec![reads(1, COMPUTE)], // made visible by the barrier before pass 1
        ]);
        assert!(barriers[1].is_some() && barriers[2].is_none());
    }

    #[test]
    fn a_read_after_a_covered_write_still_orders_a_later_write() {
        let barriers = plan(&[vec![writes(0, COMPUTE)], vec![reads(0, COMPUTE)], vec![writes(0, COMPUTE)], vec![reads(0, COMPUTE)]]);
        assert!(barriers[2].is_some() && barriers[3].is_some());
    }

    /// Every hazard of random frames is ordered by a barrier between its two passes; checked without the planner's own state.
    #[test]
    fn every_hazard_of_a_thousand_random_frames_is_covered() {
        let mut seed = 1u32;
        let mut random = |n: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 16) % n
        };
        let stages = [COMPUTE, Stages::FRAGMENT, Stages::TRANSFER];
        for _ in 0..1000 {
            let frame: Vec<Vec<Access>> = (0..8)
                .map(|_| {
                    let (first, second) = (random(4) as usize, random(4) as usize);
                    let mut access = |resource| {
                        let stage = stages[random(3) as usize];
                        [reads(resource, stage), writes(resource, stage), updates(resource, stage)][random(3) as usize]
                    };
                    if first == second { vec![access(first)] } else { vec![access(first), access(second)] }
                })
                .collect();
            let barriers = plan(&frame);
            for later in 0..frame.len() {
                for earlier in 0..later {
                    for (a, b) in frame[earlier].iter().flat_map(|a| frame[later].iter().map(move |b| (a, b))) {
                        let overwritten = frame[earlier + 1..later].iter().flatten();
                        let direct = !overwritten.clone().any(|c| c.resource == a.resource && c.accesses.intersects(Accesses::WRITES));
                        let hazard = (a.accesses | b.accesses).intersects(Accesses::WRITES);
                        if a.resource != b.resource || !direct || !hazard {
                            continue;
                        }
                        let written = a.accesses & Accesses::WRITES;
                        let covers = |barrier: &Barrier| {
                            barrier.from.contains(a.stages)
                                && barrier.to.contains(b.stages)
                                && barrier.written.contains(written)
                                && (written.is_empty() || barrier.needed.contains(b.accesses))
                        };
                        assert!(
                            barriers[earlier + 1..=later].iter().flatten().any(covers),
                            "{a:?} in pass {earlier} and {b:?} in pass {later} are not ordered by {barriers:?}"
                        );
                    }
                }
            }
        }
    }
}
