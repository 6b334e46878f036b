//! `manylight compare`: the errors of pictures against their references.

use super::short;
use crate::cli::CompareArgs;
use crate::fail;
use crate::files::prepare_folder;
use crate::metrics::{self, Comparison, Image, ImageFile, LayerPair, Measures, heatmap};
use crate::output::write_png;
use anyhow::{Context, Result};
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Compares frame by frame and prints a line for each, or JSON at the end. Thresholds are checked last, so that a failing
/// comparison still gives its figures and heatmaps.
pub fn run(args: &CompareArgs) -> Result<()> {
    let frames = frames(&args.test, &args.reference)?;
    let layers = args.layers();
    let several = frames.len() * layers.len() > 1;
    let mut results = Vec::new();
    for frame in &frames {
        let tests = images(&frame.test, layers.iter().map(|choice| choice.test.as_slice()))?;
        let references = images(&frame.reference, layers.iter().map(|choice| choice.reference.as_slice()))?;
        for ((choice, test), reference) in layers.iter().zip(&tests).zip(&references) {
            let Comparison { measures, map } = metrics::compare(test, reference).with_context(|| frame.both(choice))?;
            let result = Line { frame: &frame.name, layer: choice.to_string(), measures };
            check_thresholds(args, &result)?;
            if !args.json {
                println!("{}", result.text());
            }
            if let Some(path) = &args.heatmap {
                let path = if several { path.join(result.heatmap_name()) } else { path.clone() };
                let [width, height] = test.size();
                path.parent().filter(|folder| !folder.as_os_str().is_empty()).map_or(Ok(()), prepare_folder)?;
                write_png(&path, width as u32, height as u32, &heatmap(&map))?;
            }
            results.push(result);
        }
    }
    let summary: Vec<Line> = layers.iter().filter_map(|choice| summary(&choice.to_string(), &results)).collect();
    let over: Vec<Over> = results.iter().flat_map(|result| over(args, result)).collect();
    if args.json {
        let report = Report { test: &args.test, reference: &args.reference, frames: &results, summary: &summary, over: &over };
        println!("{}", serde_json::to_string_pretty(&report).context("the figures cannot be written as JSON")?);
    } else if frames.len() > 1 {
        summary.iter().for_each(|line| println!("{}", line.text()));
    }
    match over.as_slice() {
        [] => Ok(()),
        [first] => Err(fail!(ComparisonFailed, "{first}")),
        [first, others @ ..] => Err(fail!(ComparisonFailed, "{first}; {} more over theirs", others.len())),
    }
}

/// The layers of a file. Its other channels do not stay in memory.
fn images<'n>(path: &Path, layers: impl Iterator<Item = &'n [String]>) -> Result<Vec<Image>> {
    let file = ImageFile::open(path)?;
    layers.map(|names| file.layer(names)).collect()
}

/// A file and its reference.
struct Frame {
    name: String,
    test: PathBuf,
    reference: PathBuf,
}

impl Frame {
    fn of(test: PathBuf, reference: PathBuf) -> Self {
        Self { name: test.file_name().unwrap_or_default().to_string_lossy().into_owned(), test, reference }
    }

    fn both(&self, choice: &LayerPair) -> String {
        format!("{} and {}: layer {choice}", self.test.display(), self.reference.display())
    }
}

/// Image in a folder of `render`.
const RENDERED: &str = "image.exr";

/// Pairs of files: the two given, or those of two folders matched by name. A folder of `render` is replaced by its image.
fn frames(test: &Path, reference: &Path) -> Result<Vec<Frame>> {
    let image = |path: &Path| if path.join(RENDERED).is_file() { path.join(RENDERED) } else { path.to_owned() };
    let [test, reference] = [test, reference].map(image);
    match (test.is_dir(), reference.is_dir()) {
        (false, false) => return Ok(vec![Frame::of(test, reference)]),
        (true, true) => {}
        (test_is, _) => {
            let (folder, file) = if test_is { (test, reference) } else { (reference, test) };
            let (folder, file) = (folder.display(), file.display());
            return Err(fail!(BadInput, "{folder}: is a folder without {RENDERED}, which cannot be compared with the file {file}"));
        }
    }
    let (names, references) = (image_names(&test)?, image_names(&reference)?);
    for (folder, missing) in [(&reference, names.difference(&references)), (&test, references.difference(&names))] {
        if let Some(missing) = missing.into_iter().next() {
            return Err(fail!(BadInput, "{}: is missing, which the other folder has", folder.join(missing).display()));
        }
    }
    if names.is_empty() {
        return Err(fail!(BadInput, "{}: has no .exr and no .png file", test.display()));
    }
    Ok(names.iter().map(|name| Frame::of(test.join(name), reference.join(name))).collect())
}

/// The names of a folder's images, sorted. A PNG beside an EXR of its name shows the same frame, and is left out.
fn image_names(folder: &Path) -> Result<BTreeSet<PathBuf>> {
    let cannot = |error: std::io::Error| fail!(BadInput, "{}: cannot be read ({error})", folder.display());
    let mut names = BTreeSet::new();
    for entry in std::fs::read_dir(folder).map_err(cannot)? {
        let path = entry.map_err(cannot)?.path();
        let is_image = path.extension().is_some_and(|ending| ["exr", "png"].iter().any(|known| ending.eq_ignore_ascii_case(known)));
        names.extend(path.file_name().filter(|_| is_image).map(PathBuf::from));
    }
    let all = names.clone();
    names.retain(|name| name.extension().is_some_and(|ending| ending == "exr") || !all.contains(&name.with_extension("exr")));
    Ok(names)
}

#[derive(Serialize)]
struct Report<'r> {
    test: &'r Path,
    reference: &'r Path,
    frames: &'r [Line<'r>],
    /// One line for each layer.
    summary: &'r [Line<'r>],
    over: &'r [Over],
}

/// The figures of one layer of a frame.
#[derive(Serialize)]
struct Line<'f> {
    frame: &'f str,
    layer: String,
    #[serde(flatten)]
    measures: Measures,
}

impl Line<'_> {
    fn text(&self) -> String {
        let Measures { rmse, mae, relmse, energy, worst, flip, .. } = self.measures;
        let figures = [
            ("rmse", Some(rmse)),
            ("mae", Some(mae)),
            ("relmse", Some(relmse)),
            ("energy", energy),
            ("worst", Some(worst)),
            ("flip", flip),
        ];
        let figures = figures.iter().filter_map(|(name, figure)| figure.map(|figure| format!("  {name} {}", short(figure))));
        format!("{} {}{}", self.frame, self.layer, figures.collect::<String>())
    }

    /// File name without path separators: a layer may have any name, but must not lead to another folder.
    fn heatmap_name(&self) -> String {
        format!("{}.{}.png", self.frame, self.layer.replace(['/', '\\'], "_"))
    }
}

fn summary<'f>(layer: &str, results: &[Line]) -> Option<Line<'f>> {
    let measures: Vec<Measures> = results.iter().filter(|result| result.layer == layer).map(|result| result.measures.clone()).collect();
    Some(Line { frame: "all", layer: layer.to_owned(), measures: Measures::over_frames(&measures)? })
}

/// A figure over its threshold.
#[derive(Serialize)]
struct Over {
    frame: String,
    layer: String,
    measure: &'static str,
    figure: f64,
    threshold: f64,
}

impl std::fmt::Display for Over {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { frame, layer, measure, figure, threshold } = self;
        write!(f, "{frame}: layer {layer}: {measure} is {figure}, over its threshold of {threshold}")
    }
}

/// The measures that have a threshold: name, figure if the layer has it, and threshold.
fn limited(args: &CompareArgs, measures: &Measures) -> impl Iterator<Item = (&'static str, Option<f64>, f64)> {
    let off = measures.energy.map(|energy| (energy - 1.0).abs());
    let all = [
        ("rmse", Some(measures.rmse), args.max_rmse),
        ("mae", Some(measures.mae), args.max_mae),
        ("relmse", Some(measures.relmse), args.max_relmse),
        ("flip", measures.flip, args.max_flip),
        ("worst", Some(measures.worst), args.max_worst),
        ("energy error", off, args.max_energy_error),
    ];
    all.into_iter().filter_map(|(name, figure, limit)| limit.map(|limit| (name, figure, limit)))
}

/// Refuses a threshold for a measure that the layer lacks: any picture would keep it.
fn check_thresholds(args: &CompareArgs, result: &Line) -> Result<()> {
    match limited(args, &result.measures).find(|(_, figure, _)| figure.is_none()) {
        Some((measure, ..)) => Err(fail!(BadInput, "layer {} has no {measure} that could be held against a threshold", result.layer)),
        None => Ok(()),
    }
}

fn over(args: &CompareArgs, result: &Line) -> Vec<Over> {
    let exceeding = limited(args, &result.measures).filter_map(|(measure, figure, threshold)| {
        let figure = figure.filter(|figure| *figure > threshold)?;
        Some(Over { frame: result.frame.to_owned(), layer: result.layer.clone(), measure, figure, threshold })
    });
    exceeding.collect()
}
