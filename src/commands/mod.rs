//! The program's commands, a file each. Results go to stdout, progress and warnings to stderr.

pub mod bench;
pub mod compare;
pub mod doctor;
pub mod export;
pub mod flicker;
pub mod list;
mod measure;
mod progress;
pub mod reference;
pub mod render;
pub mod report;
pub mod reproduce;
mod truth;

use crate::cli::{Cli, Command};
use crate::config::{self, Config};
use crate::fail;
use crate::gpu::{DeviceChoice, Gpu, Options};
use crate::graph::Timing;
use crate::output::prepare_folder;
use crate::presets;
use crate::renderer::{Renderer, timing};
use crate::report::{Device, Provenance};
use crate::scene::Scene;
use crate::scene::source::load_scene;
use crate::trace;
use anyhow::Result;
use std::collections::BTreeMap;
use std::path::Path;

/// Runs a parsed command line.
pub fn run(cli: &Cli) -> Result<()> {
    match &cli.command {
        Command::Render(args) => render::run(args),
        Command::Reference(args) => reference::run(args),
        Command::Export { format } => export::run(format),
        Command::Compare(args) => compare::run(args),
        Command::Reproduce(args) => reproduce::run(args),
        Command::Report(args) => report::run(args),
        Command::Flicker(args) => flicker::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Doctor => doctor::run(),
        Command::List => list::run(),
    }
}

/// A config from a file, or by its name one of the presets that come with the program.
fn load_config(path: &Path, overrides: &[String]) -> Result<Config> {
    match path.to_str().and_then(presets::find) {
        Some(text) if !path.exists() => config::parse(text, &path.with_extension("toml"), overrides),
        _ => config::load(path, overrides),
    }
}

/// The device and the scene of a run, each while the other is waited for, and what the user should be told.
fn open(config: &Config, device: Option<&DeviceChoice>, validate: bool) -> Result<(Gpu, Scene, Vec<String>)> {
    let options = Options { device: device.cloned().unwrap_or_default(), validate };
    let (scene, gpu) = rayon::join(|| load_scene(&config.scene), || Gpu::new(&options));
    let (gpu, (scene, warnings)) = (gpu?, scene?);
    Ok((gpu, scene, warnings))
}

/// Turns the recorder on where a trace is wanted, and proves that the file can be written.
fn prepare_trace(path: Option<&Path>) -> Result<()> {
    let Some(path) = path else { return Ok(()) };
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    prepare_folder(folder.unwrap_or(Path::new(".")))?;
    trace::start();
    Ok(())
}

/// What `run.json` says of a rendered config in numbers: what the run knows, and what passes counted.
fn counts(renderer: &Renderer, config: &Config, first_pass_ms: Option<u64>, counted: &[(String, u64)]) -> BTreeMap<String, u64> {
    let known = [
        ("scene/triangles", Some(renderer.world().device().triangles)),
        ("start/first-pass-ms", first_pass_ms),
        ("vpls/count", Some(u64::from(renderer.vpl_count(config)))),
        ("device/memory-bytes", Some(renderer.gpu().memory_in_use())),
    ];
    let known = known.into_iter().filter_map(|(name, count)| Some((name.to_owned(), count?)));
    known.chain(counted.iter().cloned()).collect()
}

/// What `gather.statistics` says: VPLs on a pixel's lists and those of them that shine there, and what share of the former is wrong (the
/// false discovery rate).
fn means(counts: &BTreeMap<String, u64>) -> BTreeMap<String, f64> {
    let of = |name: &str| counts.get(name).map(|count| *count as f64);
    let mut means = BTreeMap::new();
    let Some(pixels) = of("gather/pixels").filter(|pixels| *pixels > 0.0) else { return means };
    for kind in ["diffuse", "glossy"] {
        let [listed, lit] = ["listed", "lit"].map(|what| format!("gather/{kind}-{what}"));
        if let (Some(on_list), Some(shining)) = (of(&listed), of(&lit)) {
            means.insert(listed, on_list / pixels);
            means.insert(lit, shining / pixels);
            means.insert(format!("gather/{kind}-false-discovery"), if on_list > 0.0 { 1.0 - shining / on_list } else { 0.0 });
        }
    }
    means
}

/// Where the figures of a run come from.
fn provenance(path: &Path, config: &Config, renderer: &Renderer) -> Provenance {
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

/// A sequence may be cut into more parts than it has frames.
fn no_frames(config: &Config) -> anyhow::Error {
    fail!(BadInput, "--shard: frame.count is {}, and none of these frames is in this part; take fewer parts", config.frame.count)
}

/// Four digits, and no 0 for what is merely small.
fn short(figure: f64) -> String {
    match figure {
        0.0 => "0".to_owned(),
        small if small.abs() < 1e-3 => format!("{small:.3e}"),
        large if large.abs() >= 1e5 => format!("{large:.3e}"),
        figure => format!("{figure:.4}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_are_there_where_lights_were_counted() {
        assert!(means(&[("vpls/count".to_owned(), 7)].into()).is_empty());
        let counts = [("pixels", 4), ("diffuse-listed", 0), ("diffuse-lit", 0), ("glossy-listed", 10), ("glossy-lit", 4)];
        let means = means(&counts.map(|(name, count)| (format!("gather/{name}"), count)).into());
        assert_eq!((means["gather/glossy-listed"], means["gather/glossy-lit"], means["gather/diffuse-false-discovery"]), (2.5, 1.0, 0.0));
        assert!((means["gather/glossy-false-discovery"] - 0.6).abs() < 1e-12);
    }
}
