//! The arguments of `manylight reproduce`.

use super::sequence::shard;
use super::{Shard, device, key_value};
use crate::gpu::DeviceChoice;
use crate::tables::plan::Sweep;
use clap::Args;
use std::path::{Path, PathBuf};

const SHARDS: &str = "\
On many machines, each takes a part of the runs, and one joins them:

  manylight reproduce all --shard $SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT -o part-$SLURM_ARRAY_TASK_ID   (array 1-N)
  parallel manylight reproduce all --shard {}/8 -o part-{} ::: 1 2 3 4 5 6 7 8
  manylight reproduce all --merge part-* -o tables";

#[derive(Debug, Clone, PartialEq, Args)]
#[command(after_help = SHARDS)]
pub struct ReproduceArgs {
    /// Tables that come with the program (`manylight list`), by name or by the name's part before a dash; TOML files; or all
    #[arg(required = true, value_name = "NAME|FILE|all")]
    pub tables: Vec<String>,
    /// Folder for the results, with a folder for each table [default: out/tables]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Factor for both sides of every picture
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, value_parser = scale)]
    scale: f64,
    /// Render few frames per run
    #[arg(long)]
    quick: bool,
    /// Skip runs that are done
    #[arg(long)]
    pub resume: bool,
    /// Take only every N-th run, from the I-th on, counted from 1
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with = "merge")]
    pub shard: Option<Shard>,
    /// Run nothing: join the results in the folders of shards
    #[arg(long, value_name = "DIR", num_args = 1.., conflicts_with = "resume")]
    pub merge: Vec<PathBuf>,
    /// Set a key of the config in every cell, as in --set scene.triangles=20000; may be repeated
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    sets: Vec<String>,
    /// Folder of scenes that tables use but that do not come with the program, such as sponza_crytek.glb; a built-in scene replaces a
    /// missing one
    #[arg(long, value_name = "DIR")]
    pub scenes: Option<PathBuf>,
    /// The device to render on: part of its name, its index in `manylight list`, or cpu
    #[arg(long, value_name = "NAME|INDEX|cpu", value_parser = device)]
    pub device: Option<DeviceChoice>,
    /// Turn on the Vulkan validation layer; any message fails the run
    #[arg(long)]
    pub validate: bool,
    /// Print no progress
    #[arg(short, long)]
    pub quiet: bool,
}

impl ReproduceArgs {
    pub fn output(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| Path::new("out").join("tables"))
    }

    pub fn sweep(&self) -> Sweep {
        Sweep { scale: self.scale, quick: self.quick, sets: self.sets.clone() }
    }
}

fn scale(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|x: &f64| (0.01..=8.0).contains(x)).ok_or_else(|| "expects a number from 0.01 to 8".to_owned())
}
