//! Order statistics over frames, by pass and by stage.

use super::{PassTime, stage};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Order statistics of a sample, in its own unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    pub median: f64,
    /// The 5th percentile.
    pub p5: f64,
    /// The 95th percentile.
    pub p95: f64,
    /// Size of the sample.
    pub n: usize,
}

impl Statistics {
    /// Statistics of a sample; `None` if it is empty.
    pub fn of(sample: &[f64]) -> Option<Self> {
        let mut sorted = sample.to_vec();
        sorted.sort_by(f64::total_cmp);
        let at = |q| quantile(&sorted, q);
        Some(Self { median: at(0.5)?, p5: at(0.05)?, p95: at(0.95)?, n: sorted.len() })
    }
}

/// The quantile `q` in [0, 1] of an ascending sample, by linear interpolation between the two order statistics around `q * (n -
/// 1)` (type 7 of Hyndman and Fan 1996, the default of NumPy and R).
fn quantile(sorted: &[f64], q: f64) -> Option<f64> {
    let last = sorted.len().checked_sub(1)?;
    let place = q * last as f64;
    let below = place.floor() as usize;
    let (a, b) = (sorted[below], sorted[(below + 1).min(last)]);
    Some(a + (b - a) * (place - below as f64))
}

/// Statistics of a stage or a pass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Name of the stage or the pass.
    pub name: String,
    /// Time per frame, ms, over the `n` frames in which it ran.
    #[serde(flatten)]
    pub ms: Statistics,
    /// Share of all frames' time, in [0, 1]. The shares of all stages sum to 1, and so do those of all passes.
    pub share: f64,
}

/// Times of a run's passes, in the order in which they first ran.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Timings {
    pub stages: Vec<Row>,
    pub passes: Vec<Row>,
    /// Time per frame over all passes, ms; `None` if nothing was timed.
    pub total: Option<Statistics>,
}

impl Timings {
    /// Sums each frame's times by stage, by pass and in total, and takes the statistics of these sums over the frames.
    pub fn of(times: &[PassTime]) -> Self {
        let frames = sums(times.iter().map(|time| ("", time)));
        Self {
            stages: rows(sums(times.iter().map(|time| (stage(&time.pass), time)))),
            passes: rows(sums(times.iter().map(|time| (time.pass.as_str(), time)))),
            total: frames.first().and_then(|(_, sums)| Statistics::of(sums)),
        }
    }
}

/// Time of each frame by key, ms; keys are in the order of first appearance.
fn sums<'t>(times: impl Iterator<Item = (&'t str, &'t PassTime)>) -> Vec<(&'t str, Vec<f64>)> {
    let mut keys: Vec<(&str, BTreeMap<u32, f64>)> = Vec::new();
    for (key, time) in times {
        let place = keys.iter().position(|(known, _)| *known == key).unwrap_or_else(|| {
            keys.push((key, BTreeMap::new()));
            keys.len() - 1
        });
        *keys[place].1.entry(time.frame).or_default() += time.ms;
    }
    keys.into_iter().map(|(key, frames)| (key, frames.into_values().collect())).collect()
}

fn rows(sums: Vec<(&str, Vec<f64>)>) -> Vec<Row> {
    let total: f64 = sums.iter().flat_map(|(_, frames)| frames).sum();
    let row = |(name, frames): (&str, Vec<f64>)| {
        let share = if total > 0.0 { frames.iter().sum::<f64>() / total } else { 0.0 };
        Statistics::of(&frames).map(|ms| Row { name: name.to_owned(), ms, share })
    };
    sums.into_iter().filter_map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::samples::times;

    #[test]
    fn order_statistics_have_the_known_values() {
        // Expected values from numpy.percentile with its default method.
        let hundred: Vec<f64> = (0..101).rev().map(f64::from).collect();
        let cases: [(&[f64], [f64; 3]); 5] = [
            (&[7.0], [7.0, 7.0, 7.0]),
            (&[3.0, 1.0], [2.0, 1.1, 2.9]),
            (&[4.0, 1.0, 3.0, 2.0], [2.5, 1.15, 3.85]),
            (&[10.0, 20.0, 60.0], [20.0, 11.0, 56.0]),
            (&hundred, [50.0, 5.0, 95.0]),
        ];
        for (sample, expected) in cases {
            let got = Statistics::of(sample).unwrap();
            assert_eq!(got.n, sample.len());
            for (got, expected) in [got.median, got.p5, got.p95].into_iter().zip(expected) {
                assert!((got - expected).abs() < 1e-12, "{sample:?}: {got}, expected {expected}");
            }
        }
        assert_eq!(Statistics::of(&[]), None);
    }

    #[test]
    fn stages_sum_their_passes_frame_by_frame_before_the_median_is_taken() {
        // The two passes' medians sum to 4, but the median of their sums is 11.
        let timings = Timings::of(&times(&[
            (0, "rsm/draw", 1.0),
            (0, "filter/x", 1.0),
            (0, "filter/y", 10.0),
            (1, "rsm/draw", 2.0),
            (1, "filter/x", 10.0),
            (1, "filter/y", 1.0),
            (2, "rsm/draw", 3.0),
            (2, "filter/x", 2.0),
            (2, "filter/y", 2.0),
        ]));
        let names: Vec<_> = timings.stages.iter().map(|row| row.name.as_str()).collect();
        assert_eq!(names, ["rsm", "filter"], "program order");
        assert_eq!(timings.stages[1].ms.median, 11.0);
        assert_eq!(timings.passes[1].ms.median + timings.passes[2].ms.median, 4.0);
        assert_eq!(timings.total.map(|ms| (ms.median, ms.n)), Some((12.0 + 1.0 - 1.0, 3)));
        assert!((timings.stages[0].share - 6.0 / 32.0).abs() < 1e-12);
        for rows in [&timings.stages, &timings.passes] {
            assert!((rows.iter().map(|row| row.share).sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_pass_that_runs_twice_in_a_frame_counts_once_with_its_sum() {
        let timings = Timings::of(&times(&[(0, "filter/a", 1.0), (0, "filter/a", 2.0), (1, "filter/a", 5.0)]));
        assert_eq!(timings.passes.len(), 1);
        assert_eq!((timings.passes[0].ms.median, timings.passes[0].ms.n), (4.0, 2));
    }

    #[test]
    fn a_stage_that_skips_frames_says_in_how_many_it_ran() {
        let timings = Timings::of(&times(&[(0, "bounce/a", 8.0), (0, "gather/a", 1.0), (1, "gather/a", 1.0)]));
        assert_eq!((timings.stages[0].ms.median, timings.stages[0].ms.n), (8.0, 1));
        assert_eq!(timings.total.map(|ms| (ms.median, ms.n)), Some((5.0, 2)));
    }

    #[test]
    fn no_times_are_no_rows() {
        assert_eq!(Timings::of(&[]), Timings::default());
        assert_eq!(Timings::of(&times(&[(0, "a", 0.0)])).stages[0].share, 0.0);
    }
}
