//! Reading the files of runs.

use crate::fail;
use crate::report::{Provenance, Timings};
use anyhow::Result;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Content of `run.json` as far as reports show it. Fields that an older version or another command did not write stay empty.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Record {
    #[serde(flatten)]
    pub from: Provenance,
    #[serde(default)]
    pub timings: Timings,
    #[serde(default)]
    pub counts: BTreeMap<String, u64>,
    #[serde(default)]
    pub checks: BTreeMap<String, Value>,
    #[serde(default)]
    pub warnings: Vec<String>,
    #[serde(default)]
    pub config: Value,
}

/// Content of a JSON file; `None` if it does not exist.
///
/// # Errors
/// `BadInput` with the file, the line and its fault.
pub fn json<T: DeserializeOwned>(path: &Path) -> Result<Option<T>> {
    let bytes = match std::fs::read(path) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(fail!(BadInput, "{}: cannot be read ({error})", path.display())),
    };
    serde_json::from_slice(&bytes).map(Some).map_err(|error| fail!(BadInput, "{}: is not what a report can read ({error})", path.display()))
}
