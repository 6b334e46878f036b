//! A section of the page: a table and its runs, or the runs that were given one by one.

use super::errors::{Errors, Measurer, Picture};
use super::flicker::Flicker;
use super::folders::{Group, Run};
use super::keys::{self, Keys};
use super::matching::{Match, reference_of};
use super::numbers;
use super::plot::{self, Line, Sample, Scatter};
use super::provenance::{Origins, origins, parts};
use super::record::{RecordView, reference_facts};
use super::stages::{StageTable, stage_table};
use super::table::{self, TableView};
use anyhow::Result;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A section as it is shown.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GroupView {
    pub id: String,
    pub title: String,
    pub source: Option<String>,
    pub about: Option<String>,
    pub table: Option<TableView>,
    /// What has to be known of the table.
    pub table_notes: Vec<String>,
    /// Keys of the table's runs and their places on the page.
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

/// A run's figures.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunView {
    pub id: String,
    pub label: String,
    /// Of its note in [`Origins`].
    pub mark: Option<String>,
    /// `cpu` or `gpu`, where the group has both.
    pub kind: Option<String>,
    /// Milliseconds.
    pub median: Option<String>,
    /// Milliseconds, from the 5th to the 95th percentile.
    pub range: Option<String>,
    /// Frames.
    pub n: Option<usize>,
    pub relmse: Option<String>,
    pub flip: Option<String>,
    pub energy: Option<String>,
    /// Why it has no errors.
    pub why: Option<String>,
    pub picture: Option<Picture>,
    pub heatmap: Option<Picture>,
}

/// Runs that have the same reference, or none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SetView {
    pub reference: Option<ReferenceView>,
    /// Numbers of the runs that have pictures.
    pub figures: Vec<usize>,
    /// Whether some run has a heat map.
    pub has_heatmaps: bool,
    pub plots: Vec<PlotView>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReferenceView {
    pub label: String,
    /// Samples, bounces and what is known of its own error.
    pub facts: String,
    /// Number of its picture among those that the page shares.
    pub picture: Option<usize>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlotView {
    pub scatter: Scatter,
    /// What the guide says.
    pub guide: &'static str,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FlickerView {
    pub label: String,
    pub from: String,
    pub walk: Option<String>,
    pub plot: Option<Line>,
}

/// Builds the sections; a reference's picture is in the page once, however many runs it is beside.
pub struct Builder<'l> {
    pub measurer: Measurer<'l>,
    pub shared: Vec<Picture>,
    known: BTreeMap<PathBuf, Option<usize>>,
    /// What errors are of.
    layers: String,
}

impl<'l> Builder<'l> {
    pub fn new(layers: &'l crate::cli::LayerChoice) -> Self {
        Self { measurer: Measurer::new(layers), shared: Vec::new(), known: BTreeMap::new(), layers: layers.to_string() }
    }

    /// The section of a group. `others` are references that were given one by one; `number` counts from 1.
    ///
    /// # Errors
    /// `BadInput` with the file that cannot be shown or compared.
    pub fn group(&mut self, group: &Group, others: &[Run], number: usize) -> Result<GroupView> {
        let id = format!("s{number}");
        let (origins, marks) = origins(group.runs.iter().map(|run| &run.record.from));
        let is_mixed = origins.kind.is_none();
        let matches: Vec<Match> = group.runs.iter().map(|run| reference_of(run, &group.references, others)).collect();
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
        let mut sets = Vec::new();
        let mut references: Vec<Option<&Run>> = Vec::new();
        let of = |found: &Match<'_>| matches!(found, Match::Found(_));
        for found in &matches {
            let reference = if let Match::Found(reference) = found { Some(*reference) } else { None };
            if !references.contains(&reference) {
                references.push(reference);
            }
        }
        // A reference that no run has is still something to look at.
        references.extend(group.references.iter().map(Some).filter(|reference| !references.contains(reference)).collect::<Vec<_>>());
        // Runs without a reference come last.
        references.sort_by_key(Option::is_none);
        for reference in &references {
            let members: Vec<usize> = (0..runs.len())
                .filter(|i| match (&matches[*i], reference) {
                    (Match::Found(found), Some(reference)) => found == reference,
                    (found, None) => !of(found),
                    _ => false,
                })
                .collect();
            sets.push(self.set(*reference, &members, &runs, &group.runs, &errors, &origins)?);
        }
        sets.retain(|set| !set.figures.is_empty() || set.reference.is_some() || !set.plots.is_empty());
        for (view, errors) in runs.iter_mut().zip(errors) {
            view.heatmap = errors.map(|errors| errors.heatmap);
        }
        let records = group.runs.iter().chain(references.iter().flatten().copied()).map(RecordView::of).collect();
        let key = |run: &Run| run.folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let table = group.table.as_ref().map(table::view);
        Ok(GroupView {
            title: title(group),
            source: group.table.as_ref().and_then(|table| table.source.clone()),
            about: group.table.as_ref().and_then(|table| table.about.clone()),
            table_notes: group.table.iter().zip(&table).flat_map(|(file, view)| table::notes(file, view, &group.runs)).collect(),
            table,
            targets: group.runs.iter().zip(&runs).map(|(run, view)| (key(run), view.id.clone())).collect(),
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

    fn set(
        &mut self,
        reference: Option<&Run>,
        members: &[usize],
        views: &[RunView],
        runs: &[Run],
        errors: &[Option<Errors>],
        origins: &Origins,
    ) -> Result<SetView> {
        let samples = |error: fn(&Errors) -> Option<f64>| -> Vec<Sample> {
            let sample = |&i: &usize| {
                let view = &views[i];
                Some(Sample {
                    label: view.kind.as_ref().map_or(view.label.clone(), |kind| format!("{} ({kind})", view.label)),
                    time: runs[i].record.timings.total?.median,
                    error: error(errors[i].as_ref()?)?,
                    target: view.id.clone(),
                })
            };
            members.iter().filter_map(sample).collect()
        };
        let time = format!("median frame time, ms{}", origins.kind.as_ref().map_or(String::new(), |kind| format!(", {kind}")));
        let plots = [
            (samples(|errors| Some(errors.measures.relmse)), -1.0, "relMSE", "relMSE ∝ 1/t"),
            (samples(|errors| errors.measures.flip), -0.5, "FLIP", "FLIP ∝ 1/√t"),
        ];
        let plots = plots.into_iter().filter(|(samples, ..)| !samples.is_empty()).map(|(samples, slope, name, guide)| {
            let scatter = plot::scatter(&samples, slope, &time, &format!("{name} of {}", self.layers));
            PlotView { scatter, guide }
        });
        let plots = plots.collect();
        let reference = match reference {
            Some(run) => {
                Some(ReferenceView { label: run.label.clone(), facts: reference_facts(&run.record), picture: self.reference_picture(run)? })
            }
            None => None,
        };
        Ok(SetView {
            reference,
            figures: members.iter().copied().filter(|i| views[*i].picture.is_some()).collect(),
            has_heatmaps: members.iter().any(|i| errors[*i].is_some()),
            plots,
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
    // One list, so that medians and ranges have the same decimals.
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

/// Why a run has no errors.
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
        plot: (!flicker.pairs.is_empty()).then(|| plot::line(&flicker.pairs, "frame", "RMS change to the next frame")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::LayerChoice;
    use crate::report::html::samples::run;

    fn layers() -> LayerChoice {
        LayerChoice { test: vec!["RGB".to_owned()], reference: vec!["RGB".to_owned()] }
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
        // The reference stands for itself.
        assert_eq!(view.sets.len(), 1);
        assert_eq!(view.sets[0].reference.as_ref().map(|reference| reference.facts.as_str()), Some("4 samples a pixel"));
        assert!(view.sets[0].figures.is_empty() && view.sets[0].plots.is_empty() && view.stages.is_none());
    }
}
