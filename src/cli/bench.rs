//! The arguments of `manylight bench`.

use super::{device, key_value, size};
use crate::config::choices;
use crate::gpu::DeviceChoice;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::path::PathBuf;

const FRAMES: &str = "\
Measured frame i is frame i of the config's animation, which begins again after frame.count frames; where nothing moves all
frames are the same. Frames before them, frame 0 each, are not measured: the driver compiles what it has not used yet. Nothing but counts
comes back from the device while it is measured. The last line is for a bug report: it says what ran, where, and the medians.";

#[derive(Debug, Clone, PartialEq, Args)]
#[command(after_help = FRAMES)]
pub struct BenchArgs {
    /// The config, a TOML file
    pub config: PathBuf,
    /// Measured frames
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub runs: u32,
    /// Frames before the measured ones [default: frame.warmup of the config, at least 2]
    #[arg(long, value_name = "W", value_parser = clap::value_parser!(u32).range(..=1_000_000))]
    pub warmup: Option<u32>,
    /// Write timings.csv and run.json into a folder
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Write a timeline of host and device, for ui.perfetto.dev or chrome://tracing
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// Print the whole record as JSON, in place of the table and the line
    #[arg(long, conflicts_with_all = ["quiet", "verbose"])]
    pub json: bool,
    /// Set a key of the config, as in --set gather.interleave=2; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub sets: Vec<String>,
    /// Size of the picture in pixels, as in 960x540
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Timing mode of passes
    #[arg(long, value_name = "MODE", value_parser = PossibleValuesParser::new(choices("frame.timing")).map(String::from))]
    timing: Option<String>,
    /// The device to measure: part of its name, its index in `manylight list`, or cpu
    #[arg(long, value_name = "NAME|INDEX|cpu", value_parser = device)]
    pub device: Option<DeviceChoice>,
    /// Print also the counts of passes and the memory of every resource
    #[arg(short, long)]
    pub verbose: bool,
    /// Print the line alone
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
}

impl BenchArgs {
    /// See [`super::RenderArgs::overrides`].
    pub fn overrides(&self) -> Vec<String> {
        let mut overrides = self.sets.clone();
        overrides.extend(self.size.map(|[width, height]| format!("frame.size=[{width}, {height}]")));
        overrides.extend(self.timing.as_ref().map(|mode| format!("frame.timing={mode}")));
        overrides
    }
}
