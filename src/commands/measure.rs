//! Frames of a config, measured, and the folder that they leave: what a render's and a table's runs have in common.

use super::progress::Progress;
use super::render::layers;
use super::{counts, means, provenance};
use crate::config::Config;
use crate::fail;
use crate::graph::Execution;
use crate::output::{RunReport, prepare_folder, write_exr, write_file, write_png};
use crate::renderer::{Rendered, Renderer, timing};
use crate::report::{Memory, PassTime, Timings, peak_memory_bytes, timings_csv};
use anyhow::{Context, Result};
use std::collections::BTreeMap;
use std::path::Path;

/// What the measured frames of a config gave.
pub struct Measured {
    pub times: Vec<PassTime>,
    /// The last frame, with its picture.
    pub last: Rendered,
}

/// Warms up and renders the frames of a config; the last one's picture is brought back.
pub fn frames(renderer: &mut Renderer, config: &Config, progress: &Progress) -> Result<Measured> {
    let execution = Execution { timing: timing(config, &renderer.gpu().adapter), ..Execution::default() };
    renderer.prepare(config, &[])?;
    for _ in 0..config.frame.warmup {
        renderer.warm_up(config, &execution)?;
        progress.tick();
    }
    let mut times = Vec::new();
    let mut last = None;
    for frame in 0..config.frame.count {
        let rendered = renderer.render(config, frame, frame + 1 == config.frame.count, &execution)?;
        times.extend(rendered.times.iter().map(|(pass, ms)| PassTime { frame, pass: (*pass).to_owned(), ms: *ms }));
        last = Some(rendered);
        progress.tick();
    }
    let Some(last) = last else { unreachable!("a config renders at least one frame") };
    Ok(Measured { times, last })
}

impl Measured {
    /// Writes pictures, times and the record, which comes last: where it is, all is. `name` stands for the preset's.
    pub fn write(&self, folder: &Path, name: &Path, config: &Config, renderer: &Renderer) -> Result<()> {
        prepare_folder(folder)?;
        let from = provenance(name, config, renderer);
        let Some(picture) = &self.last.picture else { unreachable!("the last frame is brought back") };
        let [width, height] = picture.size;
        write_png(&folder.join("image.png"), width, height, &picture.image)?;
        let metadata = [("version", from.version.clone()), ("preset", from.preset.clone()), ("device", from.device.name.clone())];
        write_exr(&folder.join("image.exr"), width, height, layers(picture, &config.output.layers), &metadata)?;
        write_file(&folder.join("timings.csv"), &timings_csv(&self.times, &from)?)?;
        let counted = counts(renderer, config, None, &self.last.counts);
        let report = RunReport {
            from,
            seed: u64::from(config.frame.seed),
            frames: config.frame.count,
            warmup: config.frame.warmup,
            choices: renderer.choices(config),
            timings: Timings::of(&self.times),
            means: means(&counted),
            counts: counted,
            memory: Memory::of(&self.last.memory),
            checks: BTreeMap::new(),
            warnings: [renderer.warnings(config), self.last.warnings()].concat(),
            peak_memory_bytes: peak_memory_bytes(),
            config: serde_json::to_value(config).context("the config cannot be written as JSON")?,
        };
        report.write(&folder.join("run.json"))
    }
}

/// Fails where validation was on and said something.
pub fn check_validation(renderer: &Renderer, on: bool) -> Result<()> {
    let messages = renderer.gpu().validation_messages();
    match messages.first().filter(|_| on) {
        Some(first) => Err(fail!(ComparisonFailed, "the validation layer has {} messages, the first: {first}", messages.len())),
        None => Ok(()),
    }
}
