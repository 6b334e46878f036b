//! Runs that have the same reference, or none: their pictures side by side, and their errors against their times.

use super::errors::{Errors, Picture};
use super::folders::Run;
use super::plot::{Sample, Scatter, scatter};
use super::record::reference_facts;
use serde::Serialize;

/// A reference and its runs as they are shown.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SetView {
    pub reference: Option<ReferenceView>,
    /// Numbers of the runs that have pictures.
    pub figures: Vec<usize>,
    /// Whether some run has a heat map.
    pub has_heatmaps: bool,
    /// Whether these show FLIP, which only colours have.
    pub has_flip: bool,
    pub plots: Vec<PlotView>,
}

/// A run's figures.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunView {
    pub id: String,
    pub label: String,
    /// Of its note in [`super::provenance::Origins`].
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

/// A run of a set.
pub struct Member<'r> {
    /// In its group.
    pub number: usize,
    pub view: &'r RunView,
    pub run: &'r Run,
    pub errors: Option<&'r Errors>,
}

/// A set, its reference with the number of the picture; `None` where there is nothing to show. `kind` is that of all devices, if
/// there is one.
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
