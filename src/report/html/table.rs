//! `table.json`: a published table and ours, as `manylight reproduce` writes it.

use crate::fail;
use crate::report::Device;
use anyhow::Result;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// What `table.json` says.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct TableFile {
    /// A name of its own among tables.
    pub name: String,
    pub title: String,
    /// The publication and the table's number there.
    #[serde(default)]
    pub source: Option<String>,
    #[serde(default)]
    pub about: Option<String>,
    pub version: String,
    pub device: Device,
    pub timing_mode: String,
    /// Part of the published sizes that was run.
    #[serde(default = "one")]
    pub scale: f64,
    /// Whether it ran with fewer frames or settings than asked.
    #[serde(default)]
    pub quick: bool,
    /// Whether every cell was run.
    #[serde(default = "yes")]
    pub complete: bool,
    #[serde(default)]
    pub published: Option<Published>,
    /// How ours differs from what was published.
    #[serde(default)]
    pub deviations: Vec<String>,
    pub rows: Vec<String>,
    pub columns: Vec<String>,
    /// A list a row, a cell a column.
    pub cells: Vec<Vec<Cell>>,
    /// By key, which is the name of its folder.
    #[serde(default)]
    pub runs: BTreeMap<String, TableRun>,
    /// Keys of the references.
    #[serde(default)]
    pub references: Vec<String>,
}

fn one() -> f64 {
    1.0
}

fn yes() -> bool {
    true
}

/// What the published figures are of.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Published {
    #[serde(default)]
    pub hardware: Option<String>,
    #[serde(default)]
    pub scene: Option<String>,
    #[serde(default)]
    pub settings: Option<String>,
}

/// A run of a table.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct TableRun {
    #[serde(default)]
    pub label: String,
    /// What the table set in its config.
    #[serde(default)]
    pub set: BTreeMap<String, Value>,
}

/// A figure of ours and the published one.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default)]
pub struct Cell {
    pub measure: String,
    /// `ms`, `x` for a ratio, `bytes`, or nothing.
    pub unit: String,
    /// `None` where it could not be had; then `why` says why.
    pub value: Option<f64>,
    pub p5: Option<f64>,
    pub p95: Option<f64>,
    /// Frames of a time.
    pub n: Option<usize>,
    pub published: Option<f64>,
    /// The value over that of the table's base.
    pub relative: Option<f64>,
    pub published_relative: Option<f64>,
    /// Key of the run.
    pub run: Option<String>,
    /// Key of the reference.
    pub reference: Option<String>,
    pub why: Option<String>,
}

impl TableFile {
    /// # Errors
    /// `BadInput` where the cells are not as many as the rows and columns say.
    pub fn check(&self, path: &Path) -> Result<()> {
        let path = path.display();
        if self.cells.len() != self.rows.len() {
            return Err(fail!(BadInput, "{path}: has {} rows of cells, not {}", self.cells.len(), self.rows.len()));
        }
        match self.rows.iter().zip(&self.cells).find(|(_, cells)| cells.len() != self.columns.len()) {
            Some((row, cells)) => Err(fail!(BadInput, "{path}: row {row} has {} cells, not {}", cells.len(), self.columns.len())),
            None => Ok(()),
        }
    }

    /// Key of the reference that the figures of a run are of, where the table says it.
    pub fn reference_of(&self, run: &str) -> Option<&str> {
        self.cells.iter().flatten().filter(|cell| cell.run.as_deref() == Some(run)).find_map(|cell| cell.reference.as_deref())
    }

    /// Whether a published time may stand beside ours. One of a GPU says nothing about a CPU's, only how times relate does.
    pub fn compares_times(&self) -> bool {
        self.device.kind != "cpu"
    }
}
