//! Times by stage: a row for each run, a bar for each stage.

use super::folders::Run;
use super::numbers;
use crate::report::Statistics;
use serde::Serialize;

/// All stages' bars share a scale, so that they compare across rows and columns; totals have their own.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageTable {
    /// Stages in the order of execution.
    pub stages: Vec<String>,
    /// One row for each timed run.
    pub rows: Vec<StageRow>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageRow {
    /// Index of the run in its group.
    pub run: usize,
    /// Bars of the stages; `None` for a stage that did not run.
    pub cells: Vec<Option<Bar>>,
    pub total: Option<Bar>,
}

/// A median and its bar.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bar {
    /// Median, ms.
    pub text: String,
    /// Length for the median, from 0 to 100.
    pub length: f64,
    /// Ends for the 5th and 95th percentile, from 0 to 100.
    pub spread: [f64; 2],
    /// The figures in words.
    pub title: String,
}

/// The stages of these runs; `None` if no run was timed.
pub fn stage_table(runs: &[Run]) -> Option<StageTable> {
    let timed: Vec<(usize, &Run)> = runs.iter().enumerate().filter(|(_, run)| !run.record.timings.stages.is_empty()).collect();
    if timed.is_empty() {
        return None;
    }
    let stages = order(timed.iter().map(|(_, run)| run.record.timings.stages.iter().map(|row| row.name.as_str())));
    let of = |run: &Run, stage: &str| run.record.timings.stages.iter().find(|row| row.name == stage).map(|row| row.ms);
    let total = bars(&timed.iter().map(|(_, run)| run.record.timings.total).collect::<Vec<_>>(), None);
    let largest = timed.iter().flat_map(|(_, run)| &run.record.timings.stages).map(|row| row.ms.p95.max(row.ms.median)).fold(0.0, f64::max);
    let columns: Vec<Vec<Option<Bar>>> =
        stages.iter().map(|stage| bars(&timed.iter().map(|(_, run)| of(run, stage)).collect::<Vec<_>>(), Some(largest))).collect();
    let rows = timed.iter().zip(total).enumerate().map(|(at, ((run, _), total))| StageRow {
        run: *run,
        cells: columns.iter().map(|column| column[at].clone()).collect(),
        total,
    });
    Some(StageTable { rows: rows.collect(), stages })
}

/// A column of bars. The length 100 is `scale`, or the column's largest value.
fn bars(column: &[Option<Statistics>], scale: Option<f64>) -> Vec<Option<Bar>> {
    let largest = column.iter().flatten().map(|ms| ms.p95.max(ms.median)).fold(0.0, f64::max);
    let scale = scale.unwrap_or(largest).max(f64::MIN_POSITIVE);
    let length = |ms: f64| (ms / scale * 1000.0).round() / 10.0;
    let texts = numbers::column(&column.iter().map(|ms| ms.map(|ms| ms.median)).collect::<Vec<_>>());
    let bar = |(ms, text): (&Option<Statistics>, Option<String>)| {
        let (ms, text) = ((*ms)?, text?);
        let range = format!("{} to {}", numbers::short(ms.p5), numbers::short(ms.p95));
        let title = format!("{text} ms, 5th to 95th percentile {range}, {} {}", ms.n, if ms.n == 1 { "frame" } else { "frames" });
        Some(Bar { text, length: length(ms.median), spread: [length(ms.p5), length(ms.p95)], title })
    };
    column.iter().zip(texts).map(bar).collect()
}

/// All names in a common order: a name that earlier lists lack follows its predecessor.
fn order<'n>(lists: impl Iterator<Item = impl Iterator<Item = &'n str>>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for list in lists {
        let mut after = 0;
        for name in list {
            match names.iter().position(|known| known == name) {
                Some(at) => after = at + 1,
                None => {
                    names.insert(after, name.to_owned());
                    after += 1;
                }
            }
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::Timings;
    use crate::report::html::samples::run;
    use crate::report::samples::times;

    #[test]
    fn stages_that_only_some_runs_have_stand_where_they_run() {
        let lists = [vec!["gbuffer", "gather", "compose"], vec!["gbuffer", "rsm", "gather", "filter", "compose"], vec!["late"]];
        let ordered = order(lists.iter().map(|list| list.iter().copied()));
        assert_eq!(ordered, ["late", "gbuffer", "rsm", "gather", "filter", "compose"]);
    }

    #[test]
    fn bars_share_a_scale_and_a_stage_that_did_not_run_has_none() {
        let timed = |label: &str, list: &[(u32, &str, f64)]| {
            let mut run = run(label);
            run.record.timings = Timings::of(&times(list));
            run
        };
        let runs =
            [run("untimed"), timed("a", &[(0, "gbuffer/draw", 10.0), (0, "gather/x", 40.0)]), timed("b", &[(0, "gbuffer/draw", 20.0)])];
        let table = stage_table(&runs).unwrap();
        assert_eq!(
            (table.stages.as_slice(), table.rows.len(), table.rows[0].run),
            (&["gbuffer".to_owned(), "gather".to_owned()][..], 2, 1)
        );
        let lengths = |row: usize| table.rows[row].cells.iter().map(|bar| bar.as_ref().map(|bar| bar.length)).collect::<Vec<_>>();
        assert_eq!((lengths(0), lengths(1)), (vec![Some(25.0), Some(100.0)], vec![Some(50.0), None]));
        assert_eq!(table.rows[1].total.as_ref().unwrap().length, 40.0);
        assert_eq!(table.rows[0].cells[0].as_ref().unwrap().text, "10.0");
        assert_eq!(stage_table(&runs[..1]), None);
    }
}
