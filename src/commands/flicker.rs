//! `manylight flicker CONFIG`: changes of visible surfaces from frame to frame along the config's camera path.

use super::progress::Progress;
use super::setup::{On, Ready, Setup};
use super::short;
use crate::cli::FlickerArgs;
use crate::fail;
use crate::files::{prepare_folder, write_file};
use crate::metrics::flicker::difference_map;
use crate::metrics::{Image, ImageFile, Intensity};
use crate::output::{FRAMES, frame_file, write_png};
use crate::report::{FlickerLine, Provenance, flicker_csv, resolved};
use crate::walk::{Step, Visit, Walk, check, flicker_of_walk, stands_still};
use anyhow::{Context, Result};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Content of `flicker.json`.
#[derive(Serialize)]
struct Report<'r> {
    #[serde(flatten)]
    from: &'r Provenance,
    seed: u32,
    layer: &'static str,
    frames: u32,
    #[serde(flatten)]
    walk: &'r Walk,
    /// The reference's folder and layer.
    reference_frames: Option<(&'r Path, &'r str)>,
    warnings: &'r [String],
    /// The resolved config; it gives the same path again.
    config: serde_json::Value,
}

/// Renders the camera path, prints a line for each pair of frames and one for the whole, and writes the figures.
pub fn run(args: &FlickerArgs) -> Result<()> {
    let setup = Setup::load(&args.config, &args.overrides())?;
    let config = &setup.config;
    check(config)?;
    let layer = Intensity::parse(&args.layer).context("--layer")?;
    let reference = args.reference.as_ref().map(|folder| reference_files(folder, config.frame.count)).transpose()?;
    let reference_layer = args.reference_layer.as_deref().unwrap_or(layer.name());
    let folder = args.output();
    prepare_folder(&folder)?;
    let maps = folder.join("heatmaps");
    if args.heatmap {
        prepare_folder(&maps)?;
    }
    let progress = Progress::new(args.quiet);
    let mut ready = setup.ready(On { device: args.device.as_ref(), validate: false }, &[], &progress)?;
    if stands_still(config) && !ready.renderer.world().moves() {
        ready.warn("camera: nothing moves; camera.keyframes, the keyframes of a light or an animation of the scene make a walk", &progress);
    }
    let Ready { mut renderer, from, execution, warnings, .. } = ready;

    let read = |frame: u32| -> Result<Image> {
        let files: &[PathBuf] = reference.as_deref().unwrap_or_default();
        ImageFile::open(&files[frame as usize])?.layer(&[reference_layer.to_owned()])
    };
    let count = config.frame.count;
    let mut on_frame = |visit: &Visit| -> Result<()> {
        progress.frame(visit.frame, count);
        let Some(step) = visit.step else { return Ok(()) };
        if !args.quiet && !args.json {
            progress.print(&line_of(layer, step, visit.rmse));
        }
        if let (true, Some(differences)) = (args.heatmap, visit.differences()) {
            let [width, height] = visit.picture.size;
            let path = maps.join(format!("{}.png", pair_name(step)));
            write_png(&path, width, height, &difference_map(&differences, step.pair.mean.unwrap_or(0.0)))?;
        }
        Ok(())
    };
    let reader: Option<crate::walk::ReferenceFrames> = if reference.is_some() { Some(&read) } else { None };
    let walk = flicker_of_walk(&mut renderer, config, layer, reader, &execution, &mut on_frame)?;

    progress.say("writing");
    write_file(&folder.join("flicker.csv"), &flicker_csv(&lines(&walk), layer.name(), &from)?)?;
    let report = Report {
        from: &from,
        seed: config.frame.seed,
        layer: layer.name(),
        frames: count,
        walk: &walk,
        reference_frames: args.reference.as_deref().map(|folder| (folder, reference_layer)),
        warnings: &warnings,
        config: resolved(config)?,
    };
    let mut json = serde_json::to_vec_pretty(&report).context("flicker.json cannot be put together")?;
    json.push(b'\n');
    write_file(&folder.join("flicker.json"), &json)?;
    progress.end();
    if args.json {
        print!("{}", String::from_utf8_lossy(&json));
    } else {
        println!("{}", line_of_walk(layer, &walk));
        println!("{}", folder.join("flicker.csv").display());
    }
    Ok(())
}

/// The reference's file of each frame, from the folder itself or from its `frames` folder if there is one.
fn reference_files(folder: &Path, frames: u32) -> Result<Vec<PathBuf>> {
    let inner = folder.join(FRAMES);
    let folder = if inner.is_dir() { &inner } else { folder };
    let files: Vec<PathBuf> = (0..frames).map(|frame| frame_file(folder, frame, "exr")).collect();
    match files.iter().find(|file| !file.is_file()) {
        None => Ok(files),
        Some(missing) => Err(fail!(
            BadInput,
            "--reference: {} is missing, a frame of the walk; `manylight reference CONFIG --sequence` makes the frames",
            missing.display()
        )),
    }
}

fn pair_name(step: &Step) -> String {
    format!("{:04}-{:04}", step.previous, step.next)
}

fn line_of(layer: Intensity, step: &Step, rmse: Option<f64>) -> String {
    let pair = &step.pair;
    let start = format!("{} {}", pair_name(step), layer.name());
    let (Some(flicker), Some(mean)) = (pair.flicker, pair.mean) else { return format!("{start}  no pixel is seen again") };
    let matched = pair.matched as f64 / pair.surfaces as f64;
    format!("{start}  {}{}", figures(flicker, mean, matched), against(step.reference, step.excess, rmse))
}

fn line_of_walk(layer: Intensity, walk: &Walk) -> String {
    let all = &walk.flicker;
    let rest = against(walk.reference.map(|reference| reference.flicker), walk.excess, walk.rmse_of_walk);
    let figures = figures(all.flicker, all.mean, all.matched_share);
    format!("all {}  {figures}  mean-of-pairs {}  largest {}{rest}", layer.name(), short(all.mean_of_pairs), short(all.largest))
}

fn figures(flicker: f64, mean: f64, matched: f64) -> String {
    let part = if mean > 0.0 { format!(" ({:.2} % of the mean)", 100.0 * flicker / mean) } else { String::new() };
    format!("flicker {}{part}  matched {:.1} %", short(flicker), 100.0 * matched)
}

fn against(reference: Option<f64>, excess: Option<f64>, rmse: Option<f64>) -> String {
    let figures = [("reference", reference), ("excess", excess), ("rmse", rmse)];
    figures.iter().filter_map(|(name, figure)| figure.map(|figure| format!("  {name} {}", short(figure)))).collect()
}

/// One line per frame. The first frame has no pair, only an error.
fn lines(walk: &Walk) -> Vec<FlickerLine> {
    let mut lines: Vec<FlickerLine> = vec![FlickerLine { frame: 0, ..FlickerLine::default() }];
    lines.extend(walk.steps.iter().map(|step| FlickerLine {
        frame: step.next,
        pair: Some(step.pair),
        reference: step.reference,
        excess: step.excess,
        rmse: None,
    }));
    for (line, rmse) in lines.iter_mut().zip(&walk.rmse) {
        line.rmse = Some(*rmse);
    }
    lines
}
