//! The arguments of `manylight export`.

use super::{key_value, size};
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};

#[derive(Debug, Clone, PartialEq, Subcommand)]
pub enum ExportFormat {
    /// Mitsuba 3: scene.xml, PLY meshes and textures
    Mitsuba(MitsubaArgs),
}

#[derive(Debug, Clone, PartialEq, Args)]
pub struct MitsubaArgs {
    /// The config, a TOML file
    pub config: PathBuf,
    /// Folder for the scene [default: out/<name of the config>/mitsuba]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Set a key of the config, as in --set scene.triangles=10000; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    sets: Vec<String>,
    /// Size of the picture in pixels, as in 960x540
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Frame whose camera and lights are exported [default: the last frame, as in a render]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..1_000_000))]
    pub frame: Option<u32>,
}

impl MitsubaArgs {
    /// Folder of the scene: `--output`, or `mitsuba` in a render's default folder.
    pub fn output(&self) -> PathBuf {
        let name = self.config.file_stem().unwrap_or("config".as_ref());
        self.output.clone().unwrap_or_else(|| Path::new("out").join(name).join("mitsuba"))
    }

    /// See [`super::RenderArgs::overrides`].
    pub fn overrides(&self) -> Vec<String> {
        let mut overrides = self.sets.clone();
        overrides.extend(self.size.map(|[width, height]| format!("frame.size=[{width}, {height}]")));
        overrides
    }
}
