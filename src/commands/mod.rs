//! The program's commands, a file each. Results go to stdout, progress and warnings to stderr.

pub mod compare;
pub mod doctor;
pub mod list;
pub mod render;

use crate::cli::{Cli, Command};
use anyhow::Result;

/// Runs a parsed command line.
pub fn run(cli: &Cli) -> Result<()> {
    match &cli.command {
        Command::Render(args) => render::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Doctor => doctor::run(),
        Command::List => list::run(),
    }
}
