//! `table.json`: a published table and our figures, written by `manylight reproduce`.

use crate::fail;
use crate::report::Device;
use crate::tables::Stack;
use anyhow::Result;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// Content of `table.json`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct TableFile {
    /// Name, unique among tables.
    pub name: String,
    pub title: String,
    /// The publication, and the table's number in it.
    #[serde(default)]
    pub source: Option<String>,
    #[serde(default)]
    pub about: Option<String>,
    pub version: String,
    pub device: Device,
    pub timing_mode: String,
    /// Factor on the published sizes.
    #[serde(default = "one")]
    pub scale: f64,
    /// Whether it ran with fewer frames than the table says.
    #[serde(default)]
    pub quick: bool,
    /// Whether every cell was run.
    #[serde(default = "yes")]
    pub complete: bool,
    #[serde(default)]
    pub published: Option<Published>,
    /// What shares and ratios are of.
    #[serde(default)]
    pub share_of: Option<String>,
    #[serde(default)]
    pub relative_to: Option<String>,
    /// Shares that make up a whole.
    #[serde(default)]
    pub stacks: Vec<Stack>,
    /// Scenes of the runs with their triangles, in words.
    #[serde(default)]
    pub scenes: Vec<String>,
    /// Warnings of the runs, each once.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// Differences of our runs from the paper's.
    #[serde(default)]
    pub deviations: Vec<String>,
    pub rows: Vec<String>,
    pub columns: Vec<String>,
    /// A list for each row, with a cell for each column.
    pub cells: Vec<Vec<Cell>>,
    /// Runs by key, the name of their folder.
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

/// Setup of the published figures.
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
    /// Keys that the table set in the config.
    #[serde(default)]
    pub set: BTreeMap<String, Value>,
}

/// Our figure and the published one.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default)]
pub struct Cell {
    pub measure: String,
    /// `ms`, `x` for a ratio, `bytes`, or empty.
    pub unit: String,
    /// The value; `None` if there is none, for the reason in `why`.
    pub value: Option<f64>,
    pub p5: Option<f64>,
    pub p95: Option<f64>,
    /// Standard deviation over the seeds of a mean.
    pub spread: Option<f64>,
    /// Number of frames of a time, or of the seeds of a mean.
    pub n: Option<usize>,
    pub published: Option<f64>,
    /// Share that a time is of the table's whole.
    pub share: Option<f64>,
    pub published_share: Option<f64>,
    /// The value over the table's base value.
    pub relative: Option<f64>,
    pub published_relative: Option<f64>,
    /// Key of the run.
    pub run: Option<String>,
    /// Key of the reference.
    pub reference: Option<String>,
    pub why: Option<String>,
}

impl TableFile {
    /// Checks the number of cells.
    ///
    /// # Errors
    /// `BadInput` if the cells do not match the rows and columns.
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

    /// Key of the reference for a run's figures, if the table names it.
    pub fn reference_of(&self, run: &str) -> Option<&str> {
        self.cells.iter().flatten().filter(|cell| cell.run.as_deref() == Some(run)).find_map(|cell| cell.reference.as_deref())
    }
}
