//! `manylight schema`: the JSON Schema of configs.

use crate::config;
use anyhow::Result;

/// Prints the schema.
pub fn run() -> Result<()> {
    println!("{:#}", config::schema());
    Ok(())
}
