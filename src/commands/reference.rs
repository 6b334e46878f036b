//! `manylight reference CONFIG`: ground truth by path tracing, layer by layer, with its variance.

use super::progress::Progress;
use super::{load_config, open, prepare_trace, provenance};
use crate::cli::ReferenceArgs;
use crate::config::Config;
use crate::fail;
use crate::graph::Execution;
use crate::output::exr::Precision;
use crate::output::{Layer as ExrLayer, RunReport, prepare_folder, write_exr, write_file, write_png};
use crate::reference::{Features, Layer, Settings, Sums, Tracer, develop, load_sums, save_sums};
use crate::renderer::{Renderer, timing};
use crate::report::{Memory, PassTime, Timings, peak_memory_bytes, timings_csv};
use crate::scene::Scene;
use crate::trace;
use anyhow::{Context, Result};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Set by the first Ctrl-C; the second one ends the program at once.
static STOPPED: AtomicBool = AtomicBool::new(false);

/// What has been traced is kept so often, so that a run that is cut off loses no more.
const KEPT_EVERY: Duration = Duration::from_secs(60);

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
    let of_scene = identity(&config, settings, &scene);
    let mut renderer = Renderer::traced(gpu, scene)?;
    let identity = format!("{of_scene}-{}", renderer.engine().shader_key("reference/path.comp")?.to_hex());
    let kept = folder.join("sums.exr");
    let before = if args.resume { Some(load_sums(&kept, &identity, config.frame.size, args.bounces)?) } else { None };
    let mut tracer = Tracer::new(&mut renderer, &config, settings, before.as_ref())?;
    progress.say("preparing the shaders");
    tracer.prepare(&mut renderer)?;
    // Whatever the end of the run needs is needed once before, so that it does not fail for want of memory after hours.
    let features = tracer.features(&mut renderer)?;
    tracer.sums(&mut renderer)?;

    let execution = Execution { timing: timing(&config, &renderer.gpu().adapter), ..Execution::default() };
    let (start, mut kept_at) = (Instant::now(), Instant::now());
    let mut times = Vec::new();
    let mut rays = 0;
    // A run that is stopped while it makes ready leaves one sample, so that there is something.
    while tracer.samples() < args.spp && (tracer.samples() == 0 || !STOPPED.load(Ordering::Relaxed)) {
        let _span = trace::span(format_args!("sample {}", tracer.samples()));
        let (traced, ms) = tracer.sample(&mut renderer, &execution)?;
        times.push(PassTime { frame: tracer.samples() - 1, pass: "reference/path".to_owned(), ms });
        rays += traced;
        progress.samples(u64::from(tracer.samples()), u64::from(args.spp), rays as f64 / start.elapsed().as_secs_f64());
        if args.time.is_some_and(|seconds| start.elapsed().as_secs_f64() >= seconds) {
            break;
        }
        let enough = |error: f64| args.target_error.is_some_and(|target| error <= target);
        if args.target_error.is_some() && is_checked(tracer.samples()) && enough(tracer.sums(&mut renderer)?.relative_error()) {
            break;
        }
        if kept_at.elapsed() >= KEPT_EVERY {
            save_sums(&kept, &identity, &tracer.sums(&mut renderer)?)?;
            kept_at = Instant::now();
        }
    }
    let seconds = start.elapsed().as_secs_f64();

    progress.say("writing");
    let writing = trace::span("writing");
    let sums = tracer.sums(&mut renderer)?;
    let from = provenance(&args.config, &config, &renderer);
    let [width, height] = sums.size;
    let metadata = [
        ("version", from.version.clone()),
        ("preset", from.preset.clone()),
        ("device", from.device.name.clone()),
        ("samples", sums.samples.to_string()),
    ];
    save_sums(&kept, &identity, &sums)?;
    write_exr(&folder.join("image.exr"), width, height, layers(&sums, &features), &metadata)?;
    write_png(&folder.join("image.png"), width, height, &develop(&sums, &config.compose))?;
    write_file(&folder.join("timings.csv"), &timings_csv(&times, &from)?)?;
    let error = sums.relative_error();
    let messages = renderer.gpu().validation_messages();
    let mut checks = std::collections::BTreeMap::new();
    if args.validate {
        checks.insert("validation".to_owned(), serde_json::json!(messages));
    }
    // JSON has no infinity: with one path a pixel, nothing is known.
    checks.insert("relative-standard-error".to_owned(), serde_json::json!(error.is_finite().then_some(error)));
    let counts = [
        ("reference/samples", u64::from(sums.samples)),
        ("reference/bounces", u64::from(sums.bounces)),
        ("reference/rays", rays),
        ("reference/rays-a-second", (rays as f64 / seconds.max(1e-9)) as u64),
        ("reference/frame", u64::from(settings.frame_index)),
        ("scene/hierarchy-ms", renderer.traced_scene().map_or(0, |scene| scene.build_ms)),
        ("scene/triangles", renderer.device_scene().triangles),
        ("device/memory-bytes", renderer.gpu().memory_in_use()),
    ];
    let report = RunReport {
        from,
        seed: u64::from(config.frame.seed),
        frames: times.len() as u32,
        warmup: 0,
        timings: Timings::of(&times),
        counts: counts.map(|(name, count)| (name.to_owned(), count)).into(),
        memory: Memory::of(tracer.memory()),
        checks,
        warnings,
        peak_memory_bytes: peak_memory_bytes(),
        config: serde_json::to_value(&config).context("the config cannot be written as JSON")?,
    };
    report.write(&folder.join("run.json"))?;
    drop(writing);
    if let Some(path) = &args.trace {
        trace::finish(path, &report.from)?;
    }
    progress.end();

    println!("{}", folder.join("image.png").display());
    if !args.quiet {
        let known = if error.is_finite() { format!("{:.2} %", error * 100.0) } else { "unknown".to_owned() };
        println!(
            "{} samples a pixel, {} bounces; standard error {known} of the mean; {rays} rays in {seconds:.1} s: {:.2} million a second on {} [{}]",
            sums.samples,
            sums.bounces,
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

/// The error is looked at after 16 samples and then each time that there are a quarter more: at the same counts in every run.
fn is_checked(samples: u32) -> bool {
    let mut next = 16;
    while next < samples {
        next += next / 4;
    }
    next == samples
}

/// What must be the same for a run to go on from an earlier one: a hash of the scene and of all that its light depends on.
fn identity(config: &Config, settings: Settings, scene: &Scene) -> String {
    let mut hasher = blake3::Hasher::new();
    hasher.update(bytemuck::cast_slice(&scene.vertices)).update(bytemuck::cast_slice(&scene.indices));
    for texture in &scene.textures {
        hasher.update(&texture.texels);
    }
    let textures: Vec<_> = scene.textures.iter().map(|t| (t.width, t.height, t.srgb)).collect();
    let rest = (&scene.draws, &scene.materials, textures, &scene.cameras, &scene.lights);
    let config = (&config.camera, &config.light, &config.materials, config.frame.size, config.frame.fps, config.frame.seed);
    hasher.update(format!("{rest:?} {config:?} {settings:?}").as_bytes());
    hasher.finalize().to_hex().to_string()
}

/// The EXR's layers: those of a render, and the bounces one by one and the variance of the mean radiance.
fn layers(sums: &Sums, features: &Features) -> Vec<ExrLayer> {
    let flat = |texels: Vec<[f32; 4]>| texels.into_flattened();
    let color = |name: &str, texels: Vec<[f32; 4]>| ExrLayer::interleaved(name, "RGB", 4, &flat(texels), Precision::Float);
    let mut layers = vec![
        ExrLayer::interleaved("", "RGBA", 4, &flat(sums.mean(Layer::Radiance)), Precision::Float),
        color("direct", sums.mean(Layer::Direct)),
        color("indirect", sums.indirect()),
        color("irradiance", sums.mean(Layer::Irradiance)),
        color("albedo", sums.mean(Layer::Albedo)),
        ExrLayer::interleaved("N", "XYZ", 4, features.normals_and_distances.as_flattened(), Precision::Float),
        ExrLayer::interleaved("P", "XYZ", 4, features.positions.as_flattened(), Precision::Float),
    ];
    let distances: Vec<f32> = features.normals_and_distances.iter().map(|texel| texel[3]).collect();
    layers.push(ExrLayer::interleaved("", "Z", 1, &distances, Precision::Float));
    layers.extend((1..=sums.bounces).map(|k| color(&format!("indirect.bounce{k}"), sums.mean(Layer::Bounce(k)))));
    if sums.samples > 1 {
        layers.push(ExrLayer::interleaved("variance", "RGB", 3, sums.variance().as_flattened(), Precision::Float));
    }
    layers
}
