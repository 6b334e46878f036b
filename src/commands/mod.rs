//! The program's commands, a file each. Results go to stdout, progress and warnings to stderr.

pub mod doctor;
pub mod export;
pub mod list;
pub mod render;

use crate::cli::{Cli, Command};
use crate::config::{self, Config};
use crate::presets;
use anyhow::Result;
use std::path::Path;

/// Runs a parsed command line.
pub fn run(cli: &Cli) -> Result<()> {
    match &cli.command {
        Command::Render(args) => render::run(args),
        Command::Export { format } => export::run(format),
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
