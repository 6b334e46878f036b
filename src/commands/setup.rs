//! Setting up a run: config, device, scene, warnings and shaders. Every command that shows frames begins here.

use super::progress::Progress;
use crate::config::{self, Config, Loaded};
use crate::files::prepare_folder;
use crate::gpu::{DeviceChoice, Gpu, Options};
use crate::graph::{Execution, Timing};
use crate::presets;
use crate::renderer::{Renderer, needs, timing};
use crate::report::{Device, Provenance};
use crate::scene::Scene;
use crate::scene::source::load_scene;
use crate::trace;
use crate::world::Needs;
use anyhow::Result;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// A config to run.
pub struct Setup {
    pub config: Config,
    /// Warnings of the config.
    pub warnings: Vec<String>,
    /// Path of the config; figures are listed under its name.
    path: PathBuf,
    started: Instant,
}

/// Device to run on.
#[derive(Clone, Copy)]
pub struct On<'a> {
    /// The best device if `None`.
    pub device: Option<&'a DeviceChoice>,
    /// Whether the validation layer is on.
    pub validate: bool,
}

/// A device, and a scene not yet uploaded to it.
pub struct Opened {
    gpu: Gpu,
    pub scene: Scene,
    /// Warnings about the scene.
    pub warnings: Vec<String>,
}

/// A renderer with a checked config and its pipelines, ready for frames.
pub struct Ready {
    pub renderer: Renderer,
    pub from: Provenance,
    pub execution: Execution,
    /// All warnings printed so far.
    pub warnings: Vec<String>,
    /// Time from the start to the first pass, ms.
    pub first_pass_ms: u64,
}

impl Setup {
    /// Reads a config from a file, or a preset by its name.
    ///
    /// # Errors
    /// `BadInput` with file, line and key.
    pub fn load(path: &Path, overrides: &[String]) -> Result<Self> {
        let started = Instant::now();
        let Loaded { config, warnings } = match path.to_str().and_then(|name| presets::find_unless(name, path)) {
            Some(text) => config::parse_preset(text, &path.with_extension("toml"), overrides),
            None => config::load(path, overrides),
        }?;
        Ok(Self { config, warnings, path: path.to_owned(), started })
    }

    /// Opens the device, uploads the scene, checks the config, prints warnings, and makes the pipelines. Passes in `dump` must
    /// exist.
    ///
    /// # Errors
    /// `NoDevice`, `BadInput` of the scene, of a limit or of `dump`, and the device's own.
    pub fn ready(&self, on: On, dump: &[String], progress: &Progress) -> Result<Ready> {
        let config = &self.config;
        progress.say("loading the scene");
        let opened = open(config, on)?;
        let mut warnings = [self.warnings.clone(), opened.warnings.clone()].concat();
        progress.say("bringing the scene to the device");
        let mut renderer = opened.bring(needs(config))?;
        renderer.check(config)?;
        warnings.extend(renderer.warnings(config));
        warnings.iter().for_each(|warning| progress.warn(warning));
        progress.say("preparing the shaders");
        renderer.prepare(config, dump)?;
        Ok(Ready {
            from: self.provenance(&renderer),
            execution: execution(config, &renderer),
            first_pass_ms: self.started.elapsed().as_millis() as u64,
            renderer,
            warnings,
        })
    }

    /// Provenance of the run's figures.
    pub fn provenance(&self, renderer: &Renderer) -> Provenance {
        provenance(&self.path, &self.config, renderer)
    }
}

impl Ready {
    /// Prints a warning, and keeps it for the record.
    pub fn warn(&mut self, warning: impl Into<String>, progress: &Progress) {
        let warning = warning.into();
        progress.warn(&warning);
        self.warnings.push(warning);
    }
}

/// Opens the device and loads the scene, both at the same time.
pub fn open(config: &Config, on: On) -> Result<Opened> {
    let options = Options { device: on.device.cloned().unwrap_or_default(), validate: on.validate, ..Options::default() };
    let (scene, gpu) = rayon::join(|| load_scene(&config.scene), || Gpu::new(&options));
    let (gpu, (scene, warnings)) = (gpu?, scene?);
    Ok(Opened { gpu, scene, warnings })
}

impl Opened {
    /// Uploads the scene. `may_need` covers every config that will run on it.
    pub fn bring(self, may_need: Needs) -> Result<Renderer> {
        Renderer::new(self.gpu, self.scene, may_need)
    }
}

/// Execution options of the config's frames.
pub fn execution(config: &Config, renderer: &Renderer) -> Execution {
    Execution { timing: timing(config, &renderer.gpu().adapter), ..Execution::default() }
}

/// Provenance of a config's figures, listed under the file name of `path`.
pub fn provenance(path: &Path, config: &Config, renderer: &Renderer) -> Provenance {
    let adapter = &renderer.gpu().adapter;
    let (driver, version) = adapter.driver.split_once(' ').unwrap_or((adapter.driver.as_str(), ""));
    let mode = match timing(config, adapter) {
        Timing::Isolated => "isolated",
        Timing::Overlapped => "overlapped",
        Timing::Serial => "serial",
    };
    Provenance {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        preset: path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        device: Device {
            name: adapter.name.clone(),
            kind: adapter.kind().to_owned(),
            driver: driver.to_owned(),
            driver_version: version.to_owned(),
        },
        timing_mode: mode.to_owned(),
        width: config.frame.size[0],
        height: config.frame.size[1],
    }
}

/// Starts the recorder if a trace was asked for, after a check that the folder is writable.
pub fn begin_trace(path: Option<&Path>) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    prepare_folder(folder.unwrap_or(Path::new(".")))?;
    trace::start();
    Ok(())
}

/// Writes the trace if one was asked for.
pub fn end_trace(path: Option<&Path>, from: &Provenance) -> Result<()> {
    path.map_or(Ok(()), |path| trace::finish(path, &from.known()))
}
