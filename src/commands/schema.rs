//! `manylight schema`: what a config takes, as JSON Schema.

use crate::config;
use anyhow::Result;

/// Prints the schema.
pub fn run() -> Result<()> {
    println!("{:#}", config::schema());
    Ok(())
}
