//! One frame of a reference: tracing, saving sums, writing.

use super::STOPPED;
use crate::commands::progress::Progress;
use crate::config::Config;
use crate::graph::Execution;
use crate::output::exr::Precision;
use crate::output::{ExrLayer, read_exr, write_exr, write_png};
use crate::reference::{Features, Settings, Sum, Sums, Tracer, develop, save_sums};
use crate::renderer::Renderer;
use crate::report::{PassTime, Provenance, RunReport};
use crate::trace;
use anyhow::Result;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Interval at which sums are saved: a run that is cut off loses no more.
const KEPT_EVERY: Duration = Duration::from_secs(60);

/// Paths of a frame's files.
pub struct Files {
    pub sums: PathBuf,
    pub exr: PathBuf,
    pub png: PathBuf,
}

/// Conditions that end a frame.
#[derive(Debug, Clone, Copy)]
pub struct Goal {
    /// Paths per pixel at most.
    pub spp: u32,
    /// Relative standard error to reach.
    pub target_error: Option<f64>,
    /// Time, s.
    pub time: Option<f64>,
}

/// Data that all frames of a run share.
pub struct Run<'r> {
    pub goal: Goal,
    /// Whether times are listed by frame and not by sample.
    pub is_sequence: bool,
    pub config: &'r Config,
    pub execution: &'r Execution,
    pub progress: &'r Progress,
    pub from: Provenance,
}

/// Result of a frame.
pub struct Traced {
    pub samples: u32,
    pub rays: u64,
    pub seconds: f64,
    /// Times of the samples that this run traced.
    pub times: Vec<PassTime>,
    /// [`Sums::relative_error`].
    pub error: f64,
    /// Bytes of a submission's resources, by name.
    pub memory: Vec<(String, u64)>,
}

impl Run<'_> {
    /// Whether a frame needs no more samples.
    fn is_done(&self, samples: u32, error: impl FnOnce() -> Result<f64>) -> Result<bool> {
        if samples >= self.goal.spp {
            return Ok(true);
        }
        match self.goal.target_error {
            Some(target) if is_checked(samples) => Ok(error()? <= target),
            _ => Ok(false),
        }
    }

    /// The frame as an earlier run left it, if no sample is missing: its sums, and pictures of as many samples.
    pub fn finished(&self, files: &Files, before: &Sums) -> Result<Option<Traced>> {
        let error = before.relative_error();
        if !self.is_done(before.samples, || Ok(error))? || !files.png.is_file() || !files.exr.is_file() {
            return Ok(None);
        }
        let samples = format!("samples: {}", before.samples);
        let is_of_them = read_exr(&files.exr).is_ok_and(|exr| exr.comments.lines().any(|line| line == samples));
        Ok(is_of_them.then_some(Traced { samples: before.samples, rays: 0, seconds: 0.0, times: Vec::new(), error, memory: Vec::new() }))
    }

    /// Traces a frame until a goal is reached, and writes it: the sums last, so that sums imply the other files.
    pub fn trace(
        &self,
        renderer: &mut Renderer,
        settings: Settings,
        identity: &str,
        before: Option<&Sums>,
        files: &Files,
    ) -> Result<Traced> {
        let mut tracer = Tracer::new(renderer, self.config, settings, before)?;
        self.progress.say("preparing the shaders");
        tracer.prepare(renderer)?;
        // Features and sums are read once before tracing: a lack of memory shows now and not after hours.
        let features = tracer.features(renderer)?;
        tracer.sums(renderer)?;

        let goal = self.goal;
        let (start, mut kept_at) = (Instant::now(), Instant::now());
        let mut times = Vec::new();
        let mut rays = 0;
        // A run that is stopped during its preparation still traces one sample, so that there is a result.
        while tracer.samples() < goal.spp && (tracer.samples() == 0 || !STOPPED.load(Ordering::Relaxed)) {
            let _span = trace::span(format_args!("sample {}", tracer.samples()));
            let (traced, ms) = tracer.sample(renderer, self.execution)?;
            let frame = if self.is_sequence { settings.frame_index } else { tracer.samples() - 1 };
            times.push(PassTime { frame, pass: "reference/path".to_owned(), ms });
            rays += traced;
            self.progress.samples(u64::from(tracer.samples()), u64::from(goal.spp), rays as f64 / start.elapsed().as_secs_f64());
            if goal.time.is_some_and(|seconds| start.elapsed().as_secs_f64() >= seconds) {
                break;
            }
            if self.is_done(tracer.samples(), || Ok(tracer.sums(renderer)?.relative_error()))? {
                break;
            }
            if kept_at.elapsed() >= KEPT_EVERY {
                save_sums(&files.sums, identity, &tracer.sums(renderer)?)?;
                kept_at = Instant::now();
            }
        }
        let seconds = start.elapsed().as_secs_f64();

        self.progress.say("writing");
        let sums = tracer.sums(renderer)?;
        let memory = tracer.memory().to_vec();
        tracer.free(renderer);
        self.write(&sums, &features, files)?;
        save_sums(&files.sums, identity, &sums)?;
        Ok(Traced { samples: sums.samples, rays, seconds, times, error: sums.relative_error(), memory })
    }

    fn write(&self, sums: &Sums, features: &Features, files: &Files) -> Result<()> {
        let [width, height] = sums.size;
        let metadata = [&self.from.of_image()[..], &[("samples", sums.samples.to_string())]].concat();
        write_exr(&files.exr, width, height, layers(sums, features), &metadata)?;
        write_png(&files.png, width, height, &develop(sums, &self.config.compose))
    }
}

impl Run<'_> {
    /// The record of a traced frame, without warnings.
    pub fn record(&self, renderer: &Renderer, settings: Settings, traced: &Traced) -> Result<RunReport> {
        let counts = [
            ("reference/samples", u64::from(traced.samples)),
            ("reference/bounces", u64::from(settings.bounces)),
            ("reference/rays", traced.rays),
            ("reference/rays-a-second", (traced.rays as f64 / traced.seconds.max(1e-9)) as u64),
            ("reference/frame", u64::from(settings.frame_index)),
            ("scene/hierarchy-ms", renderer.world().traced().map_or(0, |scene| scene.build_ms)),
            ("scene/triangles", renderer.world().device().triangles),
            ("device/memory-bytes", renderer.gpu().memory_in_use()),
        ];
        Ok(RunReport {
            frames: traced.times.len() as u32,
            counts: counts.map(|(name, count)| (name.to_owned(), count)).into(),
            checks: self.checks(settings, traced.error),
            ..RunReport::of(&self.from, renderer.shaders(), self.config, &traced.times, &traced.memory)?
        })
    }

    /// The reference's standard error, and its variant.
    pub fn checks(&self, settings: Settings, error: f64) -> BTreeMap<String, Value> {
        // JSON has no infinity; with one path per pixel the error is unknown.
        let error = json!(error.is_finite().then_some(error));
        let of = json!({ "centers": settings.centered, "min_distance": settings.min_distance });
        [("relative-standard-error".to_owned(), error), ("reference".to_owned(), of)].into()
    }
}

/// Whether the error is estimated at this count: at 16 samples, then after every quarter more, the same counts in every run.
fn is_checked(samples: u32) -> bool {
    let mut next = 16;
    while next < samples {
        next += next / 4;
    }
    next == samples
}

/// The EXR's layers: a render's, each bounce, and the variance of the mean radiance.
fn layers(sums: &Sums, features: &Features) -> Vec<ExrLayer> {
    let flat = |texels: Vec<[f32; 4]>| texels.into_flattened();
    let color = |name: &str, texels: Vec<[f32; 4]>| ExrLayer::interleaved(name, "RGB", 4, &flat(texels), Precision::Float);
    let mut layers = vec![
        ExrLayer::interleaved("", "RGBA", 4, &flat(sums.mean(Sum::Radiance)), Precision::Float),
        color("direct", sums.mean(Sum::Direct)),
        color("indirect", sums.indirect()),
        color("irradiance", sums.mean(Sum::Irradiance)),
        color("albedo", sums.mean(Sum::Albedo)),
        ExrLayer::interleaved("N", "XYZ", 4, features.normals_and_distances.as_flattened(), Precision::Float),
        ExrLayer::interleaved("P", "XYZ", 4, features.positions.as_flattened(), Precision::Float),
    ];
    let distances: Vec<f32> = features.normals_and_distances.iter().map(|texel| texel[3]).collect();
    layers.push(ExrLayer::interleaved("", "Z", 1, &distances, Precision::Float));
    layers.extend((1..=sums.bounces).map(|k| color(&format!("indirect.bounce{k}"), sums.mean(Sum::Bounce(k)))));
    if sums.samples > 1 {
        layers.push(ExrLayer::interleaved("variance", "RGB", 3, sums.variance().as_flattened(), Precision::Float));
    }
    layers
}
