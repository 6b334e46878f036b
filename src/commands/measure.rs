//! Warming up and measuring a config's frames, and writing their results: shared by `render`, `bench` and `reproduce`.

use super::progress::Progress;
use crate::config::Config;
use crate::fail;
use crate::files::write_file;
use crate::graph::Execution;
use crate::output::{Picture, write_exr, write_png};
use crate::renderer::{Rendered, Renderer};
use crate::report::{PassTime, Provenance, RunReport, timings_csv};
use crate::{stages, trace};
use anyhow::Result;
use std::collections::BTreeMap;
use std::path::Path;

/// The frames to run, and the results to bring back.
pub struct Frames<'a> {
    /// Frames that run first and are not measured: the driver compiles pipelines at their first use.
    pub warmup: u32,
    /// The measured frames in order: the number that their times are listed under, and the frame of the config's animation.
    pub measured: &'a [(u32, u32)],
    pub pictures: Pictures,
    /// Passes whose results in the last frame are kept.
    pub dump: &'a [String],
    /// Whether NaNs and infinities are counted in the last frame.
    pub check_nan: bool,
}

/// Frames whose pictures are read back. Reading back is outside the measured times.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Pictures {
    None,
    Last,
    All,
}

/// Results of measured frames.
pub struct Measured {
    pub times: Vec<PassTime>,
    /// Results of the last frame.
    pub last: Rendered,
    frames: u32,
    warmup: u32,
}

impl Frames<'_> {
    /// Runs the frames. `on_frame` gets each measured frame with its number.
    ///
    /// # Errors
    /// The device's own, with the pass, and those of `on_frame`.
    pub fn run(
        &self,
        renderer: &mut Renderer,
        config: &Config,
        execution: &Execution,
        progress: Option<&Progress>,
        on_frame: &mut dyn FnMut(u32, &Rendered) -> Result<()>,
    ) -> Result<Measured> {
        for i in 0..self.warmup {
            if let Some(progress) = progress {
                progress.say(&format!("warm-up frame {} of {}", i + 1, self.warmup));
            }
            let _span = trace::span(format_args!("warm-up frame {i}"));
            renderer.warm_up(config, execution)?;
        }
        let frames = self.measured.len() as u32;
        let (mut times, mut last) = (Vec::new(), None);
        for (done, (number, frame)) in (0..).zip(self.measured.iter().copied()) {
            if let Some(progress) = progress {
                progress.frame(done, frames);
            }
            let _span = trace::span(format_args!("frame {number}"));
            let is_last = done + 1 == frames;
            let mut execution = execution.clone();
            if is_last {
                (execution.dump, execution.check_nan) = (self.dump.to_vec(), self.check_nan);
            }
            let pictured = self.pictures == Pictures::All || (is_last && self.pictures == Pictures::Last);
            let rendered = renderer.render(config, frame, pictured, &execution)?;
            times.extend(rendered.times.iter().map(|(pass, ms)| PassTime { frame: number, pass: (*pass).to_owned(), ms: *ms }));
            on_frame(number, &rendered)?;
            last = is_last.then_some(rendered);
        }
        let Some(last) = last else { unreachable!("at least one frame is measured") };
        Ok(Measured { times, last, frames, warmup: self.warmup })
    }
}

impl Measured {
    /// The picture of the last frame.
    pub fn picture(&self) -> &Picture {
        self.last.picture.as_ref().unwrap_or_else(|| unreachable!("the last frame's picture was asked for"))
    }

    /// The record of the run.
    pub fn record(
        &self,
        renderer: &Renderer,
        config: &Config,
        from: &Provenance,
        first_pass_ms: Option<u64>,
        warnings: Vec<String>,
    ) -> Result<RunReport> {
        let counts = self.counts(renderer, config, first_pass_ms);
        Ok(RunReport {
            frames: self.frames,
            warmup: self.warmup,
            choices: renderer.choices(config),
            means: stages::means(&counts),
            counts,
            warnings,
            ..RunReport::of(from, renderer.shaders(), config, &self.times, &self.last.memory)?
        })
    }

    /// Counts of the run itself, and those of its passes.
    fn counts(&self, renderer: &Renderer, config: &Config, first_pass_ms: Option<u64>) -> BTreeMap<String, u64> {
        let known = [
            ("scene/triangles", Some(renderer.world().device().triangles)),
            ("start/first-pass-ms", first_pass_ms),
            ("vpls/count", Some(u64::from(renderer.vpl_count(config)))),
            ("light-caches/count", renderer.light_cache_count(config)),
            ("device/memory-bytes", Some(renderer.gpu().memory_in_use())),
        ];
        let known = known.into_iter().filter_map(|(name, count)| Some((name.to_owned(), count?)));
        known.chain(self.last.counts.iter().cloned()).collect()
    }

    /// Writes the times to `path` as CSV.
    pub fn write_times(&self, path: &Path, from: &Provenance) -> Result<()> {
        write_file(path, &timings_csv(&self.times, from)?)
    }
}

/// Writes a frame as EXR, with the layers that the config names, and as PNG.
pub fn write_picture(exr: &Path, png: &Path, picture: &Picture, config: &Config, from: &Provenance) -> Result<()> {
    let [width, height] = picture.size;
    write_png(png, width, height, &picture.image)?;
    write_exr(exr, width, height, picture.layers(&config.output.layers), &from.of_image())
}

/// Fails if the validation layer reported anything.
pub fn check_validation(renderer: &Renderer) -> Result<()> {
    let messages = renderer.gpu().validation_messages();
    match messages.first() {
        Some(first) => Err(fail!(ComparisonFailed, "the validation layer has {} messages, the first: {first}", messages.len())),
        None => Ok(()),
    }
}
