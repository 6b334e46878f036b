//! The program: parse, run, and end with the code of what went wrong.

use manylight::{cli, commands, error};
use std::process::ExitCode;

fn main() -> ExitCode {
    match commands::run(&cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("manylight: {error:#}");
            ExitCode::from(error::exit_code(&error) as u8)
        }
    }
}
