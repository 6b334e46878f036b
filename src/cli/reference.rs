//! The arguments of `manylight reference`.

use super::{SequenceArgs, device, key_value, size};
use crate::gpu::DeviceChoice;
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Clone, PartialEq, Args)]
pub struct ReferenceArgs {
    /// The config, a TOML file
    pub config: PathBuf,
    /// Folder for the results [default: out/<name of the config>/reference]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    #[command(flatten)]
    pub sequence: SequenceArgs,
    /// Paths per pixel
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=16_000_000))]
    pub spp: u32,
    /// Bounces of indirect light, each a layer of its own
    #[arg(long, value_name = "B", default_value_t = 4, value_parser = clap::value_parser!(u32).range(0..=i64::from(crate::reference::MOST_BOUNCES)))]
    pub bounces: u32,
    /// Stop after this time, at the end of a sample; in a sequence it holds for each frame
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    pub time: Option<f64>,
    /// Stop when the standard error of the pixels (root mean square) is under this part of the mean radiance
    #[arg(long, value_name = "E", value_parser = positive)]
    pub target_error: Option<f64>,
    /// Continue from the results in the folder; finished frames of a sequence stay as they are
    #[arg(long)]
    pub resume: bool,
    /// Clamp the light of near surfaces by gather.min_distance, as VPLs do: the limit that VPLs converge to, and not the truth
    #[arg(long)]
    pub min_distance: bool,
    /// Trace only through pixel centres, as a rasterized frame does: edges are as jagged, for comparing pixel by pixel
    #[arg(long)]
    pub centers: bool,
    /// Frame whose camera and lights are traced [default: the last frame, as in a render]
    #[arg(long, value_name = "N", conflicts_with = "sequence", value_parser = clap::value_parser!(u32).range(..1_000_000))]
    pub frame: Option<u32>,
    /// Set a key of the config, as in --set frame.seed=2; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    sets: Vec<String>,
    /// Size of the picture in pixels, as in 960x540
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// The device to trace on: part of its name, its index in `manylight list`, or cpu
    #[arg(long, value_name = "NAME|INDEX|cpu", value_parser = device)]
    pub device: Option<DeviceChoice>,
    /// Turn on the Vulkan validation layer; any message fails the run
    #[arg(long)]
    pub validate: bool,
    /// Write a timeline of host and device, for ui.perfetto.dev or chrome://tracing
    #[arg(long, value_name = "FILE")]
    pub trace: Option<PathBuf>,
    /// Print no progress
    #[arg(short, long)]
    pub quiet: bool,
}

impl ReferenceArgs {
    /// Folder of the results: `--output`, or `reference` in a render's default folder.
    pub fn output(&self) -> PathBuf {
        let name = self.config.file_stem().unwrap_or("config".as_ref());
        self.output.clone().unwrap_or_else(|| Path::new("out").join(name).join("reference"))
    }

    /// See [`super::RenderArgs::overrides`].
    pub fn overrides(&self) -> Vec<String> {
        let mut overrides = self.sets.clone();
        overrides.extend(self.size.map(|[width, height]| format!("frame.size=[{width}, {height}]")));
        overrides
    }
}

fn positive(text: &str) -> Result<f64, String> {
    text.parse::<f64>().ok().filter(|value| value.is_finite() && *value > 0.0).ok_or_else(|| "expects a number over 0".to_owned())
}
