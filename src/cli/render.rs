//! The arguments of `manylight render`.

use super::{SequenceArgs, device, key_value, size};
use crate::config::choices;
use crate::gpu::DeviceChoice;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::path::{Path, PathBuf};

#[derive(Debug, Clone, PartialEq, Args)]
pub struct RenderArgs {
    /// The config, a TOML file
    pub config: PathBuf,
    /// Folder for the results [default: out/<name of the config>]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Set a key of the config, as in --set gather.interleave=2; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    sets: Vec<String>,
    /// Measured frames
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: Option<u32>,
    /// Size of the picture in pixels, as in 960x540
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    #[command(flatten)]
    pub sequence: SequenceArgs,
    /// Timing mode of passes
    #[arg(long, value_name = "MODE", value_parser = PossibleValuesParser::new(choices("frame.timing")).map(String::from))]
    timing: Option<String>,
    /// The device to render on: part of its name, its index in `manylight list`, or cpu
    #[arg(long, value_name = "NAME|INDEX|cpu", value_parser = device)]
    pub device: Option<DeviceChoice>,
    /// Turn on the Vulkan validation layer; any message fails the run
    #[arg(long)]
    pub validate: bool,
    /// Write the results of a pass, as in --dump gather/per-pixel; may be repeated
    #[arg(long, value_name = "PASS")]
    pub dump: Vec<String>,
    /// Count NaNs and infinities after every pass
    #[arg(long)]
    pub check_nan: bool,
    /// Write a timeline of host and device, for ui.perfetto.dev or chrome://tracing
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// Print also the times of passes, their counts and the memory of every resource
    #[arg(short, long)]
    pub verbose: bool,
    /// Print neither progress nor the table of times
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
}

impl RenderArgs {
    /// Folder of the results: `--output`, or `out/` and the config's name without its ending.
    pub fn output(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| Path::new("out").join(self.config.file_stem().unwrap_or("config".as_ref())))
    }

    /// Changes to the config, for [`crate::config::load`]: the `--set` options in order, then the options that have a name.
    pub fn overrides(&self) -> Vec<String> {
        let mut overrides = self.sets.clone();
        overrides.extend(self.frames.map(|frames| format!("frame.count={frames}")));
        overrides.extend(self.size.map(|[width, height]| format!("frame.size=[{width}, {height}]")));
        overrides.extend(self.timing.as_ref().map(|mode| format!("frame.timing={mode}")));
        overrides
    }
}
