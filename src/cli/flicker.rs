//! The arguments of `manylight flicker`.

use super::{device, key_value, size};
use crate::gpu::DeviceChoice;
use clap::Args;
use std::path::{Path, PathBuf};

const MEASURE: &str = "\
Each pixel is looked for in the next frame by its world position; what is hidden, out of the picture or turned by more than
20 degrees there is left out. Flicker is the root mean square of the changes of luminance of those that are found, the
temporal image difference of Barak, Bittner and Havran 2013. That of a walk is over all pixels of all its pairs.

A gradient shows by up to half a pixel of it, in a reference too: what is left over the reference's own flicker is the
method's. The reference's noise counts as its flicker, so trace it until its standard error is well below; with --centers
its edges are as jagged as those of the frames.";

#[derive(Debug, Clone, PartialEq, Args)]
#[command(after_help = MEASURE)]
pub struct FlickerArgs {
    /// The config, a TOML file; its keyframes and its scene's animation are the camera path
    pub config: PathBuf,
    /// Folder for the results [default: out/<name of the config>/flicker]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Layer whose flicker is measured: RGB (the picture's radiance), direct, indirect or irradiance (without surfaces'
    /// textures)
    #[arg(long, value_name = "LAYER", default_value = "RGB")]
    pub layer: String,
    /// Folder with a reference of each frame, as `manylight reference CONFIG --sequence` writes
    #[arg(long, value_name = "DIR")]
    pub reference: Option<PathBuf>,
    /// Layer of the reference's files [default: that of --layer]
    #[arg(long, value_name = "LAYER", requires = "reference")]
    pub reference_layer: Option<String>,
    /// Write a PNG of changes for each pair of frames, from black to pale yellow (half of the mean); pixels left out are teal
    #[arg(long)]
    pub heatmap: bool,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Set a key of the config, as in --set vpls.count=4096; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    sets: Vec<String>,
    /// Frames of the camera path
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    frames: Option<u32>,
    /// Size of the picture in pixels, as in 960x540
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// The device to render on: part of its name, its index in `manylight list`, or cpu
    #[arg(long, value_name = "NAME|INDEX|cpu", value_parser = device)]
    pub device: Option<DeviceChoice>,
    /// Print no progress, and only the figures of the whole path
    #[arg(short, long)]
    pub quiet: bool,
}

impl FlickerArgs {
    /// Folder of the results: `--output`, or `flicker` in a render's default folder.
    pub fn output(&self) -> PathBuf {
        let name = self.config.file_stem().unwrap_or("config".as_ref());
        self.output.clone().unwrap_or_else(|| Path::new("out").join(name).join("flicker"))
    }

    /// See [`super::RenderArgs::overrides`].
    pub fn overrides(&self) -> Vec<String> {
        let mut overrides = self.sets.clone();
        overrides.extend(self.frames.map(|frames| format!("frame.count={frames}")));
        overrides.extend(self.size.map(|[width, height]| format!("frame.size=[{width}, {height}]")));
        overrides
    }
}
