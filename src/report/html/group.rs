//! A section of the page: a table with its runs, or the runs given one by one.

use super::errors::{Errors, Measurer, Picture};
use super::flicker::Flicker;
use super::folders::{Group, Run};
use super::keys::{self, Keys};
use super::matching::{Match, differences, reference_of};
use super::numbers;
use super::plot::{self, Line};
use super::provenance::{Origins, origins, parts};
use super::record::RecordView;
use super::set::{Member, RunView, SetView, set_view};
use super::stacks::{self, Stacks};
use super::stages::{StageTable, stage_table};
use super::table_view::{self, TableView};
use crate::metrics::LayerPair;
use anyhow::Result;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A section in the form that the template takes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupView {
    pub id: String,
    pub title: String,
    pub source: Option<String>,
    pub about: Option<String>,
    pub table: Option<TableView>,
    /// Shares of the table's whole.
    pub stacks: Option<Stacks>,
    /// Notes on the table.
    pub table_notes: Vec<String>,
    /// Keys of the table's runs, and their anchors on the page.
    pub targets: BTreeMap<String, String>,
    pub origins: Origins,
    pub keys: Keys,
    pub runs: Vec<RunView>,
    pub sets: Vec<SetView>,
    pub stages: Option<StageTable>,
    pub flickers: Vec<FlickerView>,
    pub records: Vec<RecordView>,
    pub missing: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlickerView {
    pub label: String,
    pub from: String,
    pub walk: Option<String>,
    pub plot: Option<Line>,
}

/// Builds the sections. A reference's picture is embedded once, for any number of runs.
pub struct Builder<'l> {
    measurer: Measurer<'l>,
    pub shared: Vec<Picture>,
    known: BTreeMap<PathBuf, Option<usize>>,
    /// Layers that errors are measured on.
    layers: String,
}

impl<'l> Builder<'l> {
    pub fn new(layers: &'l LayerPair) -> Self {
        Self { measurer: Measurer::new(layers), shared: Vec::new(), known: BTreeMap::new(), layers: layers.to_string() }
    }

    /// The section of a group. `others` are references given one by one; `number` counts from 1.
    ///
    /// # Errors
    /// `BadInput` with the file that cannot be shown or compared.
    pub fn group(&mut self, group: &Group, others: &[Run], number: usize) -> Result<GroupView> {
        let id = format!("s{number}");
        let (origins, marks) = origins(group.runs.iter().map(|run| &run.record.from));
        let is_mixed = origins.kind.is_none();
        let matches: Vec<Match> = group.runs.iter().map(|run| group_reference(group, run, others)).collect();
        let mut errors = Vec::new();
        for (run, found) in group.runs.iter().zip(&matches) {
            errors.push(match found {
                Match::Found(reference) => self.measurer.errors(run, reference)?,
                _ => None,
            });
        }
        let mut runs = run_views(&group.runs, &errors, &id);
        for ((view, run), (mark, found)) in runs.iter_mut().zip(&group.runs).zip(marks.into_iter().zip(&matches)) {
            view.mark = mark;
            view.kind = is_mixed.then(|| run.record.from.device.kind.clone());
            view.picture = run.picture().map(|path| Picture::read(&path)).transpose()?;
            if view.relmse.is_none() {
                view.why = why(found);
            }
        }
        let references = references(group, &matches);
        let mut sets = Vec::new();
        for reference in &references {
            let is_of = |i: &usize| found(&matches[*i]) == *reference;
            let members: Vec<Member> = (0..runs.len())
                .filter(is_of)
                .map(|number| Member { number, view: &runs[number], run: &group.runs[number], errors: errors[number].as_ref() })
                .collect();
            let reference = reference.map(|run| Ok::<_, anyhow::Error>((run, self.reference_picture(run)?))).transpose()?;
            sets.extend(set_view(reference, &members, origins.kind.as_deref(), &self.layers));
        }
        for (view, errors) in runs.iter_mut().zip(errors) {
            view.heatmap = errors.map(|errors| errors.heatmap);
        }
        let records = group.runs.iter().chain(references.iter().flatten().copied()).map(RecordView::of).collect();
        let table = group.table.as_ref().map(table_view::view);
        Ok(GroupView {
            title: title(group),
            source: group.table.as_ref().and_then(|table| table.source.clone()),
            about: group.table.as_ref().and_then(|table| table.about.clone()),
            table_notes: group.table.iter().zip(&table).flat_map(|(file, view)| table_view::notes(file, view, &group.runs)).collect(),
            table,
            stacks: group.table.as_ref().and_then(stacks::stacks),
            targets: group.runs.iter().zip(&runs).map(|(run, view)| (run.key(), view.id.clone())).collect(),
            keys: keys::differing(&group.runs),
            runs,
            sets,
            stages: stage_table(&group.runs),
            flickers: group.flickers.iter().map(flicker).collect(),
            records,
            missing: group.missing.clone(),
            origins,
            id,
        })
    }

    fn reference_picture(&mut self, run: &Run) -> Result<Option<usize>> {
        if let Some(known) = self.known.get(&run.folder) {
            return Ok(*known);
        }
        let picture = run.picture().map(|path| Picture::read(&path)).transpose()?;
        let number = picture.map(|picture| {
            self.shared.push(picture);
            self.shared.len() - 1
        });
        self.known.insert(run.folder.clone(), number);
        Ok(number)
    }
}

fn found<'r>(found: &Match<'r>) -> Option<&'r Run> {
    if let Match::Found(reference) = found { Some(reference) } else { None }
}

/// The references that a group shows, each once: those of its runs, then its others, which are shown too. `None` comes last if
/// there are runs without a reference.
fn references<'r>(group: &'r Group, matches: &[Match<'r>]) -> Vec<Option<&'r Run>> {
    let mut references: Vec<Option<&Run>> = Vec::new();
    for reference in matches.iter().map(found).chain(group.references.iter().map(Some)) {
        if !references.contains(&reference) {
            references.push(reference);
        }
    }
    references.sort_by_key(Option::is_none);
    references
}

/// The reference of a run: the one named by its table if their sizes agree, otherwise one that agrees with the run.
fn group_reference<'r>(group: &'r Group, run: &Run, others: &'r [Run]) -> Match<'r> {
    let named = group.table.as_ref().and_then(|table| table.reference_of(&run.key()));
    let named = named.and_then(|key| group.references.iter().find(|reference| reference.key() == key));
    match named.filter(|reference| !differences(run, reference).contains(&"size")) {
        Some(reference) => Match::Found(reference),
        None => reference_of(run, &group.references, others),
    }
}

fn title(group: &Group) -> String {
    match &group.table {
        Some(table) => table.title.clone(),
        None if !group.runs.is_empty() => "Runs".to_owned(),
        None if !group.references.is_empty() => "References".to_owned(),
        None => "Flicker".to_owned(),
    }
}

fn run_views(runs: &[Run], errors: &[Option<Errors>], group: &str) -> Vec<RunView> {
    let totals: Vec<_> = runs.iter().map(|run| run.record.timings.total).collect();
    // Medians and ranges are formatted as one column, so that they have the same decimals.
    let times = totals.iter().flat_map(|total| total.map_or([None; 3], |ms| [ms.median, ms.p5, ms.p95].map(Some)));
    let times = numbers::column(&times.collect::<Vec<_>>());
    let view = |(i, run): (usize, &Run)| {
        let measures = errors[i].as_ref().map(|errors| &errors.measures);
        let [median, low, high] = std::array::from_fn(|part| times[i * 3 + part].clone());
        RunView {
            id: format!("{group}-r{}", i + 1),
            label: run.label.clone(),
            mark: None,
            kind: None,
            median,
            range: low.zip(high).map(|(low, high)| format!("{low}–{high}")),
            n: totals[i].map(|ms| ms.n),
            relmse: measures.map(|measures| numbers::short(measures.relmse)),
            flip: measures.and_then(|measures| measures.flip).map(numbers::short),
            energy: measures.and_then(|measures| measures.energy).map(numbers::short),
            why: None,
            picture: None,
            heatmap: None,
        }
    };
    runs.iter().enumerate().map(view).collect()
}

/// Reason for a run's lack of errors.
fn why(found: &Match) -> Option<String> {
    match found {
        Match::Found(_) => Some("no layers to compare".to_owned()),
        Match::Nearest(reference, differing) => Some(format!("no reference; {} differs in {}", reference.label, differing.join(", "))),
        Match::Nothing => None,
    }
}

fn flicker(flicker: &Flicker) -> FlickerView {
    FlickerView {
        label: flicker.label.clone(),
        from: flicker.from.as_ref().map_or(String::new(), |from| parts(from).join("; ")),
        walk: flicker.walk.map(numbers::short),
        plot: (!flicker.pairs.is_empty()).then(|| plot::line(&flicker.pairs, "frame", "RMS change from frame to frame")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::html::samples::run;

    fn layers() -> LayerPair {
        LayerPair::radiance()
    }

    #[test]
    fn a_run_without_pictures_has_its_figures_and_the_reason_for_what_is_missing() {
        let mut reference = run("truth");
        reference.record.counts.insert("reference/samples".to_owned(), 4);
        reference.record.from.width = 1;
        let group = Group { runs: vec![run("a")], references: vec![reference], ..Group::default() };
        let layers = layers();
        let view = Builder::new(&layers).group(&group, &[], 1).unwrap();
        assert_eq!(view.runs[0].why.as_deref(), Some("no reference; truth differs in size"));
        assert_eq!(view.runs[0].id, "s1-r1");
        // The reference is shown on its own.
        assert_eq!(view.sets.len(), 1);
        assert_eq!(view.sets[0].reference.as_ref().map(|reference| reference.facts.as_str()), Some("4 samples a pixel"));
        assert!(view.sets[0].figures.is_empty() && view.sets[0].plots.is_empty() && view.stages.is_none());
    }

    #[test]
    fn a_reference_that_the_table_names_comes_before_one_that_has_more_samples() {
        let reference = |label: &str, samples| {
            let mut run = run(label);
            run.record.counts.insert("reference/samples".to_owned(), samples);
            run
        };
        let table = |named: Option<&str>| {
            serde_json::from_value(serde_json::json!({
                "name": "t", "title": "T", "version": "0.1.0", "timing_mode": "isolated",
                "device": { "name": "d", "kind": "cpu", "driver": "e", "driver_version": "1" },
                "rows": ["a"], "columns": ["b"], "cells": [[{ "value": 1, "run": "k1", "reference": named }]],
            }))
            .unwrap()
        };
        let references = || vec![reference("many", 64), reference("few", 4)];
        let found = |named: Option<&str>, change: fn(&mut Run)| {
            let mut group = Group { table: Some(table(named)), runs: vec![run("k1")], references: references(), ..Group::default() };
            group.references.iter_mut().for_each(change);
            super::found(&group_reference(&group, &group.runs[0], &[])).map(|reference| reference.label.clone())
        };
        assert_eq!(found(None, |_| ()).as_deref(), Some("many"));
        assert_eq!(found(Some("few"), |_| ()).as_deref(), Some("few"));
        assert_eq!(found(Some("gone"), |_| ()).as_deref(), Some("many"));
        assert_eq!(found(Some("few"), |reference| reference.record.from.width = 1), None, "pictures of two sizes cannot be compared");
    }

    #[test]
    fn where_a_cpu_and_a_gpu_are_side_by_side_each_run_says_which_it_is() {
        let mut gpu = run("b");
        gpu.record.from.device.kind = "gpu".to_owned();
        let layers = layers();
        let kinds = |runs: Vec<Run>| {
            let view = Builder::new(&layers).group(&Group { runs, ..Group::default() }, &[], 1).unwrap();
            let of_runs = view.runs.iter().map(|run| run.kind.clone()).collect::<Vec<_>>();
            (view.origins.kind, of_runs)
        };
        assert_eq!(kinds(vec![run("a"), run("b")]), (Some("cpu".to_owned()), vec![None, None]));
        assert_eq!(kinds(vec![run("a"), gpu]), (None, vec![Some("cpu".to_owned()), Some("gpu".to_owned())]));
    }
}
