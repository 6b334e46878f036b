//! `manylight reference CONFIG`: ground truth by path tracing, layer by layer, with its variance.

pub(super) mod frame;

use super::progress::Progress;
use super::{load_config, open, prepare_trace, provenance};
use crate::cli::ReferenceArgs;
use crate::config::Config;
use crate::fail;
use crate::graph::Execution;
use crate::output::{RunReport, prepare_folder, write_file};
use crate::reference::{Settings, identity, load_sums, scene_digest};
use crate::renderer::{Renderer, timing};
use crate::report::timings_csv;
use crate::trace;
use anyhow::Result;
use frame::{Files, Goal, Run, Traced};
use std::sync::atomic::{AtomicBool, Ordering};

/// Set by the first Ctrl-C; the second one ends the program at once.
static STOPPED: AtomicBool = AtomicBool::new(false);

/// Traces until something says stop, and writes everything.
pub fn run(args: &ReferenceArgs) -> Result<()> {
    let config = load_config(&args.config, &args.overrides())?;
    let folder = args.output();
    prepare_folder(&folder)?;
    prepare_trace(args.trace.as_deref())?;
    let _ = ctrlc::set_handler(|| {
        if STOPPED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    let progress = Progress::new(args.quiet);
    progress.say("loading the scene");
    let (gpu, scene, warnings) = open(&config, args.device.as_ref(), args.validate)?;
    warnings.iter().for_each(|warning| progress.warn(warning));
    let settings = Settings {
        bounces: args.bounces,
        frame_index: args.frame.unwrap_or(config.frame.count - 1),
        min_distance: if args.min_distance { config.gather.min_distance } else { 0.0 },
        centered: args.centers,
    };
    progress.say("building the hierarchy");
    let digest = scene_digest(&scene);
    let mut renderer = Renderer::traced(gpu, scene)?;
    let identity = truth_identity(&mut renderer, &config, settings, &digest)?;
    let files = Files { sums: folder.join("sums.exr"), exr: folder.join("image.exr"), png: folder.join("image.png") };
    let before = if args.resume { Some(load_sums(&files.sums, &identity, config.frame.size, args.bounces)?) } else { None };
    let execution = Execution { timing: timing(&config, &renderer.gpu().adapter), ..Execution::default() };
    let goal = Goal { spp: args.spp, target_error: args.target_error, time: args.time };
    let from = provenance(&args.config, &config, &renderer);
    let run = Run { goal, is_sequence: false, config: &config, execution: &execution, progress: &progress, from };
    let traced = run.trace(&mut renderer, settings, &identity, before.as_ref(), &files)?;
    let Traced { samples, rays, seconds, error, .. } = traced;
    write_file(&folder.join("timings.csv"), &timings_csv(&traced.times, &run.from)?)?;
    let messages = renderer.gpu().validation_messages();
    let mut checks = std::collections::BTreeMap::new();
    if args.validate {
        checks.insert("validation".to_owned(), serde_json::json!(messages));
    }
    let report = RunReport {
        checks: checks.into_iter().chain(run.checks(settings, error)).collect(),
        warnings,
        ..run.record(&renderer, settings, &traced)?
    };
    report.write(&folder.join("run.json"))?;
    if let Some(path) = &args.trace {
        trace::finish(path, &report.from)?;
    }
    progress.end();

    println!("{}", folder.join("image.png").display());
    if !args.quiet {
        let known = if error.is_finite() { format!("{:.2} %", error * 100.0) } else { "unknown".to_owned() };
        println!(
            "{} samples a pixel, {} bounces; standard error {known} of the mean; {rays} rays in {seconds:.1} s: {:.2} million a second on {} [{}]",
            samples,
            args.bounces,
            rays as f64 / seconds.max(1e-9) / 1e6,
            report.from.device.name,
            report.from.device.kind
        );
    }
    if let Some(first) = messages.first() {
        return Err(fail!(ComparisonFailed, "the validation layer has {} messages, the first: {first}", messages.len()));
    }
    Ok(())
}

/// As [`identity`], on a device's shaders.
pub(super) fn truth_identity(renderer: &mut Renderer, config: &Config, settings: Settings, digest: &str) -> Result<String> {
    Ok(format!("{}-{}", identity(config, settings, digest), renderer.engine().shader_key("reference/path.comp")?.to_hex()))
}
