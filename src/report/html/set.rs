//! Runs with the same reference, or without one: pictures side by side, and errors against times.

use super::errors::{Errors, Picture};
use super::folders::Run;
use super::plot::{Sample, Scatter, scatter};
use super::record::reference_facts;
use serde::Serialize;

/// A reference and its runs in the form that the template takes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SetView {
    pub reference: Option<ReferenceView>,
    /// Indices of the runs with pictures.
    pub figures: Vec<usize>,
    /// Whether any run has a heatmap.
    pub has_heatmaps: bool,
    /// Whether the heatmaps show FLIP, which only colours have.
    pub has_flip: bool,
    pub plots: Vec<PlotView>,
}

/// A run's figures.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunView {
    pub id: String,
    pub label: String,
    /// Mark of its note in [`super::provenance::Origins`].
    pub mark: Option<String>,
    /// `cpu` or `gpu`, if the group has both.
    pub kind: Option<String>,
    /// Median frame time, ms.
    pub median: Option<String>,
    /// 5th to 95th percentile of frame times, ms.
    pub range: Option<String>,
    /// Number of frames.
    pub n: Option<usize>,
    pub relmse: Option<String>,
    pub flip: Option<String>,
    pub energy: Option<String>,
    /// Reason for missing errors.
    pub why: Option<String>,
    pub picture: Option<Picture>,
    pub heatmap: Option<Picture>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReferenceView {
    pub label: String,
    /// Samples, bounces and standard error.
    pub facts: String,
    /// Index of its picture among the page's shared ones.
    pub picture: Option<usize>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlotView {
    pub scatter: Scatter,
    /// The law that the guide shows.
    pub guide: &'static str,
}

/// A run of a set.
pub struct Member<'r> {
    /// Index in its group.
    pub number: usize,
    pub view: &'r RunView,
    pub run: &'r Run,
    pub errors: Option<&'r Errors>,
}

/// A set with its reference and the index of the reference's picture; `None` if there is nothing to show. `kind` is that of all
/// devices, if it is the same.
pub fn set_view(reference: Option<(&Run, Option<usize>)>, members: &[Member], kind: Option<&str>, layers: &str) -> Option<SetView> {
    let samples = |error: fn(&Errors) -> Option<f64>| -> Vec<Sample> {
        let sample = |member: &Member| {
            let label = member.view.label.clone();
            Some(Sample {
                label: member.view.kind.as_ref().map_or(label.clone(), |kind| format!("{label} ({kind})")),
                time: member.run.record.timings.total?.median,
                error: error(member.errors?)?,
                target: member.view.id.clone(),
            })
        };
        members.iter().filter_map(sample).collect()
    };
    let time = format!("median frame time, ms{}", kind.map_or(String::new(), |kind| format!(", {kind}")));
    let plots = [
        (samples(|errors| Some(errors.measures.relmse)), -1.0, "relMSE", "relMSE ∝ 1/t"),
        (samples(|errors| errors.measures.flip), -0.5, "FLIP", "FLIP ∝ 1/√t"),
    ];
    let plots = plots.into_iter().filter(|(samples, ..)| !samples.is_empty()).map(|(samples, slope, name, guide)| {
        let scatter = scatter(&samples, slope, &time, &format!("{name} of {layers}"));
        PlotView { scatter, guide }
    });
    let figures: Vec<usize> = members.iter().filter(|member| member.view.picture.is_some()).map(|member| member.number).collect();
    let reference =
        reference.map(|(run, picture)| ReferenceView { label: run.label.clone(), facts: reference_facts(&run.record), picture });
    let has_flip = members.iter().any(|member| member.errors.is_some_and(|errors| errors.measures.flip.is_some()));
    let has_heatmaps = members.iter().any(|member| member.errors.is_some());
    (reference.is_some() || !figures.is_empty()).then(|| SetView { reference, figures, has_heatmaps, has_flip, plots: plots.collect() })
}
