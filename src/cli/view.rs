//! The arguments of `manylight view`.

use super::{device, key_value, size};
use crate::gpu::DeviceChoice;
use clap::Args;
use std::path::PathBuf;

const KEYS: &str = "\
In the picture: drag to look around, drag with the right button to orbit what was clicked, W A S D to fly, E and Q for up and down,
the wheel for the speed, F to see the whole scene, C for the config's camera. Everything else is in the panels, and every change can
be saved as a config, or copied as a command line that makes the same picture.";

#[derive(Debug, Clone, PartialEq, Args)]
#[command(after_help = KEYS)]
pub struct ViewArgs {
    /// The config, a TOML file or a preset's name
    #[arg(default_value = "linke")]
    pub config: PathBuf,
    /// Set a key of the config, as in --set gather.interleave=2; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    sets: Vec<String>,
    /// Size of the picture in pixels, as in 960x540
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// The device to render on: part of its name, its index in `manylight list`, or cpu
    #[arg(long, value_name = "NAME|INDEX|cpu", value_parser = device)]
    pub device: Option<DeviceChoice>,
    /// Turn on the Vulkan validation layer; any message fails the run
    #[arg(long)]
    pub validate: bool,
}

impl ViewArgs {
    /// See [`super::RenderArgs::overrides`].
    pub fn overrides(&self) -> Vec<String> {
        let mut overrides = self.sets.clone();
        overrides.extend(self.size.map(|[width, height]| format!("frame.size=[{width}, {height}]")));
        overrides
    }
}
