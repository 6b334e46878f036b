//! The program's commands, one file each. Results go to stdout, progress and warnings to stderr.

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
pub mod schema;
mod setup;
mod truth;
pub mod view;

use crate::cli::{Cli, Command};
use crate::config::Config;
use crate::fail;
use anyhow::Result;

/// Runs a parsed command line.
pub fn run(cli: &Cli) -> Result<()> {
    match &cli.command {
        Command::Render(args) => render::run(args),
        Command::View(args) => view::run(args),
        Command::Reference(args) => reference::run(args),
        Command::Export { format } => export::run(format),
        Command::Compare(args) => compare::run(args),
        Command::Reproduce(args) => reproduce::run(args),
        Command::Report(args) => report::run(args),
        Command::Flicker(args) => flicker::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Doctor => doctor::run(),
        Command::List => list::run(),
        Command::Schema => schema::run(),
    }
}

/// The error of a shard without frames: a sequence may be cut into more parts than it has frames.
fn no_frames(config: &Config) -> anyhow::Error {
    fail!(BadInput, "--shard: frame.count is {}, and none of these frames is in this part; take fewer parts", config.frame.count)
}

/// Formats with four digits; small figures are written with an exponent, so that none but 0 is printed as 0.
fn short(figure: f64) -> String {
    match figure {
        0.0 => "0".to_owned(),
        small if small.abs() < 1e-3 => format!("{small:.3e}"),
        large if large.abs() >= 1e5 => format!("{large:.3e}"),
        figure => format!("{figure:.4}"),
    }
}
