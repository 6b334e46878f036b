//! `manylight reference CONFIG`: path-traced references with layers and variance, of one frame or of all.

pub(super) mod frame;

use self::frame::{Files, Goal, Run, Traced};
use super::measure::check_validation;
use super::no_frames;
use super::progress::Progress;
use super::setup::{self, On, Setup, begin_trace, end_trace};
use crate::cli::ReferenceArgs;
use crate::config::Config;
use crate::fail;
use crate::files::{prepare_folder, write_file};
use crate::graph::Part;
use crate::output::{FRAMES, frame_file};
use crate::reference::{self, Settings, identity, load_sums, scene_digest};
use crate::renderer::Renderer;
use crate::report::RunReport;
use crate::report::{PassTime, timings_csv};
use crate::world::Needs;
use anyhow::Result;
use serde_json::json;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by the first Ctrl-C; the second one ends the program at once.
static STOPPED: AtomicBool = AtomicBool::new(false);

/// Folder of the sums of a sequence's frames, in the run's folder.
const SUMS: &str = "sums";

/// Traces until a goal is reached or the user stops, and writes everything.
pub fn run(args: &ReferenceArgs) -> Result<()> {
    let setup = Setup::load(&args.config, &args.overrides())?;
    let (config, sequence) = (&setup.config, args.sequence);
    let folder = args.output();
    let frames: Vec<u32> = match sequence.sequence {
        true => sequence.frames(config.frame.count).collect(),
        false => vec![args.frame.unwrap_or(config.frame.count - 1)],
    };
    let Some(last_frame) = frames.last().copied() else { return Err(no_frames(config)) };
    prepare_folder(&folder)?;
    begin_trace(args.trace.as_deref())?;
    if sequence.sequence {
        prepare_folder(&folder.join(FRAMES))?;
        prepare_folder(&folder.join(SUMS))?;
    }
    let _ = ctrlc::set_handler(|| {
        if STOPPED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    let progress = Progress::new(args.quiet);
    progress.say("loading the scene");
    let opened = setup::open(config, On { device: args.device.as_ref(), validate: args.validate })?;
    let warnings = [setup.warnings.clone(), opened.warnings.clone()].concat();
    warnings.iter().for_each(|warning| progress.warn(warning));
    progress.say("building the hierarchy");
    let digest = scene_digest(&opened.scene);
    let rays = Needs { rays: true };
    let mut renderer = opened.bring(rays)?;
    renderer.ensure(rays)?;
    let execution = setup::execution(config, &renderer);
    let from = setup.provenance(&renderer);
    let goal = Goal { spp: args.spp, target_error: args.target_error, time: args.time };
    let run = Run { goal, is_sequence: sequence.sequence, config, execution: &execution, progress: &progress, from };

    let mut traced: Vec<(u32, Traced)> = Vec::new();
    for frame in frames.iter().copied() {
        // A run that is stopped during its preparation still begins its first frame.
        if !traced.is_empty() && STOPPED.load(Ordering::Relaxed) {
            break;
        }
        let settings = settings(args, config, frame);
        let identity = truth_identity(&mut renderer, config, settings, &digest)?;
        let files = files(&folder, sequence.sequence.then_some(frame));
        // A frame of a sequence may not have been begun yet; a run of one frame that cannot be resumed is a mistake.
        let resumes = args.resume && (!sequence.sequence || files.sums.exists());
        let before = if resumes { Some(load_sums(&files.sums, &identity, config.frame.size, args.bounces)?) } else { None };
        let finished = match &before {
            Some(before) if sequence.sequence => run.finished(&files, before)?,
            _ => None,
        };
        let skipped = finished.is_some();
        let of_frame = match finished {
            Some(finished) => finished,
            None => run.trace(&mut renderer, settings, &identity, before.as_ref(), &files)?,
        };
        if sequence.sequence && !args.quiet {
            let how = if skipped { "done before" } else { "traced" };
            progress.print(&format!("{frame:04}  {} samples, standard error {}, {how}", of_frame.samples, percent(of_frame.error)));
        }
        traced.push((frame, of_frame));
    }
    // A part with the sequence's last frame writes it as image too, as the whole sequence does.
    let leaves_image = sequence.sequence && last_frame + 1 == config.frame.count && traced.len() == frames.len();
    if leaves_image {
        for ending in ["exr", "png"] {
            copy(&frame_file(&folder.join(FRAMES), last_frame, ending), &folder.join("image").with_extension(ending))?;
        }
    }

    let times: Vec<PassTime> = traced.iter().flat_map(|(_, frame)| frame.times.iter().cloned()).collect();
    write_file(&folder.join(sequence.file_name("timings", "csv")), &timings_csv(&times, &run.from)?)?;
    let mut checks = std::collections::BTreeMap::new();
    if args.validate {
        checks.insert("validation".to_owned(), json!(renderer.gpu().validation_messages()));
    }
    if sequence.sequence {
        let figures =
            |frame: &Traced| json!({ "samples": frame.samples, "relative-standard-error": frame.error.is_finite().then_some(frame.error) });
        checks.insert("frames".to_owned(), traced.iter().map(|(frame, of_frame)| (format!("{frame:04}"), figures(of_frame))).collect());
    }
    let frames_made = if sequence.sequence { traced.len() } else { times.len() } as u32;
    let last_made = traced.last().map_or(last_frame, |(frame, _)| *frame);
    // The record of several frames has the fewest samples and the largest error among them.
    let whole = Traced {
        samples: traced.iter().map(|(_, frame)| frame.samples).min().unwrap_or(0),
        rays: traced.iter().map(|(_, frame)| frame.rays).sum(),
        seconds: traced.iter().map(|(_, frame)| frame.seconds).sum(),
        error: traced.iter().map(|(_, frame)| frame.error).fold(0.0, f64::max),
        memory: traced.last().map(|(_, frame)| frame.memory.clone()).unwrap_or_default(),
        times,
    };
    let record = run.record(&renderer, settings(args, config, last_made), &whole)?;
    let report = RunReport { frames: frames_made, checks: checks.into_iter().chain(record.checks).collect(), warnings, ..record };
    let Traced { samples, rays, seconds, error, .. } = whole;
    report.write(&folder.join(sequence.file_name("run", "json")))?;
    end_trace(args.trace.as_deref(), &report.from)?;
    progress.end();

    let shown = if sequence.sequence { folder.join(FRAMES) } else { folder.join("image.png") };
    println!("{}", shown.display());
    if !args.quiet {
        if traced.len() < frames.len() {
            println!("stopped after {} of {} frames; --resume goes on", traced.len(), frames.len());
        }
        println!(
            "{samples} samples a pixel, {} bounces; standard error {} of the mean; {rays} rays in {seconds:.1} s: {:.2} million a second on {} [{}]",
            args.bounces,
            percent(error),
            rays as f64 / f64::max(seconds, 1e-9) / 1e6,
            report.from.device.name,
            report.from.device.kind
        );
    }
    check_validation(&renderer)
}

fn percent(error: f64) -> String {
    if error.is_finite() { format!("{:.2} %", error * 100.0) } else { "unknown".to_owned() }
}

/// Files of a run of one frame, or of a frame of a sequence.
fn files(folder: &Path, frame: Option<u32>) -> Files {
    match frame {
        None => Files { sums: folder.join("sums.exr"), exr: folder.join("image.exr"), png: folder.join("image.png") },
        Some(frame) => {
            let in_frames = |ending| frame_file(&folder.join(FRAMES), frame, ending);
            Files { sums: frame_file(&folder.join(SUMS), frame, "exr"), exr: in_frames("exr"), png: in_frames("png") }
        }
    }
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    let bytes = std::fs::read(from).map_err(|error| fail!(OutputNotWritten, "{}: cannot be read again ({error})", from.display()))?;
    write_file(to, &bytes)
}

fn settings(args: &ReferenceArgs, config: &Config, frame_index: u32) -> Settings {
    let min_distance = if args.min_distance { config.gather.min_distance } else { 0.0 };
    Settings { bounces: args.bounces, frame_index, min_distance, centered: args.centers }
}

/// [`identity`] and the key of the path tracer's shader.
pub(super) fn truth_identity(renderer: &mut Renderer, config: &Config, settings: Settings, digest: &str) -> Result<String> {
    renderer.ensure_sky(config)?;
    let map = config.sky_map().and_then(|(_, path)| renderer.world().skies().map(path));
    let parts: &[Part] = if map.is_some() { &[reference::SKY_MAP] } else { &[] };
    let digest = map.map_or_else(|| digest.to_owned(), |map| format!("{digest} {}", map.digest));
    Ok(format!("{}-{}", identity(config, settings, &digest), renderer.engine().shader_key("reference/path.comp", parts)?.to_hex()))
}
