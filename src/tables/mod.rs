//! Tables: sweeps over configs, measured cell by cell, beside a paper's published figures.
//!
//! A table is a TOML file ([`read`]). A cell's config is the table's base with the settings of the table, the row and the
//! column. Cells with the same config share one run ([`plan`]). A run's folder has the same files as one of `manylight render`.
//! Cells are computed from these folders alone ([`cells`]), so that a sweep can be stopped, resumed, and split over machines.

pub mod cells;
pub mod folders;
mod measures;
mod nodes;
pub mod plan;
pub mod print;
pub mod read;
pub mod sheet;

pub use cells::{Cell, Results};
pub use plan::{Names, Plan, Run};

use crate::config::tree::{Node, Origin};
use crate::metrics::{Intensity, LayerPair};

#[cfg(test)]
mod tests;

/// A table as read from its file. Every row has a cell for each column.
pub struct Table {
    /// Name of the file without its ending.
    pub name: String,
    pub title: String,
    /// Paper, and table in it, that this one reproduces.
    pub source: Option<String>,
    pub about: Option<String>,
    /// Notes for readers: departures from the paper, and limits of the figures.
    pub deviations: Vec<String>,
    pub published: Option<Published>,
    pub reference: ReferenceGoal,
    /// Whether the cells' pictures are put side by side in `sheet.png`.
    pub sheet: bool,
    pub rows: Vec<Line>,
    pub columns: Vec<Line>,
    /// Measure of cells whose row and column have none.
    measure: Option<Measure>,
    /// Cell whose time is the whole that other times are shares of: the frame.
    share_of: Option<Place>,
    /// Cell whose figure others are also divided by: times, and what else the paper has.
    relative_to: Option<Place>,
    base: crate::config::Base,
    set: Option<Node>,
    /// The scene that the base's replaces, if its file is available.
    original: Option<Node>,
}

/// A row or a column.
pub struct Line {
    pub name: String,
    /// Name in the file: that of the stand-in where another scene has replaced it. Published figures go by it.
    pub written: String,
    /// Settings of its cells, over the table's.
    set: Option<Node>,
    measure: Option<Measure>,
    /// Whether it is our own, and not in the paper.
    pub own: bool,
    /// Whether its times are sums of other lines'.
    sum: bool,
    origin: Origin,
}

/// A paper's published figures and their setup.
#[derive(Debug, Clone, PartialEq)]
pub struct Published {
    pub hardware: Option<String>,
    pub scene: Option<String>,
    pub settings: Option<String>,
    /// Figures row by row; `None` if the paper has none.
    pub figures: Vec<Vec<Option<f64>>>,
}

/// Quality of the reference that errors are measured against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceGoal {
    /// Bounces of indirect light.
    pub bounces: u32,
    /// Relative standard error to reach.
    pub error: f64,
    /// Paths per pixel at most.
    pub samples: u32,
    /// Whether light of near surfaces is clamped by `gather.min_distance`, as for VPLs.
    pub min_distance: bool,
    /// Whether paths go through pixel centres only, as in rasterization.
    pub centers: bool,
}

impl Default for ReferenceGoal {
    fn default() -> Self {
        Self { bounces: 1, error: 0.01, samples: 4096, min_distance: true, centers: true }
    }
}

/// The measure of a cell.
#[derive(Debug, Clone)]
pub struct Measure {
    pub what: What,
    /// Seeds whose mean the cell shows, from the config's on.
    pub seeds: u32,
    origin: Origin,
}

#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// Median time of a stage, of a pass, of several summed (`gather+filter`), or of the whole frame (`frame`), ms.
    Time { of: String },
    /// Ratio of two other cells' values.
    Ratio { of: Place, over: Place },
    /// Error of a layer against the reference or another cell's layer.
    Error { figure: Figure, layer: LayerPair, against: Against },
    /// Flicker of a layer over the config's frames: the temporal image difference.
    Flicker { layer: Intensity },
    /// A pass's count in the last frame.
    Count { of: String },
    /// Bytes of the frame's own resources: of a stage, of one resource, or of all (`frame`).
    Memory { of: String },
}

/// A figure of [`crate::metrics::Measures`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    Rmse,
    Mae,
    Relmse,
    Energy,
    Worst,
    Flip,
}

impl Figure {
    pub const ALL: [(&'static str, Self); 6] = [
        ("rmse", Self::Rmse),
        ("mae", Self::Mae),
        ("relmse", Self::Relmse),
        ("energy", Self::Energy),
        ("worst", Self::Worst),
        ("flip", Self::Flip),
    ];

    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, figure)| *figure == self).map_or("", |(name, _)| name)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub enum Against {
    Reference,
    Cell(Place),
}

/// A line of cells whose times are shares of one whole, such as the stages of a frame, as two stacked bars: ours and the paper's.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Stack {
    /// The row or column.
    pub name: String,
    pub parts: Vec<Part>,
}

/// A part of a [`Stack`].
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Part {
    /// The column or row.
    pub name: String,
    /// Of the whole, from 0 to 1.
    pub share: Option<f64>,
    pub published_share: Option<f64>,
}

/// A cell of the same table, by indices. An absent row or column is the referring cell's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    pub row: Option<usize>,
    pub column: Option<usize>,
}

impl Place {
    /// The cell meant by a reference in the cell at `row` and `column`.
    pub fn from(self, row: usize, column: usize) -> (usize, usize) {
        (self.row.unwrap_or(row), self.column.unwrap_or(column))
    }
}

impl Table {
    /// The measure of a cell: its column's, its row's or the table's.
    pub fn measure(&self, row: usize, column: usize) -> &Measure {
        let own = self.columns[column].measure.as_ref().or(self.rows[row].measure.as_ref());
        own.or(self.measure.as_ref()).unwrap_or_else(|| unreachable!("a table without a measure for a cell is refused"))
    }

    /// A cell that others refer to, in words.
    fn named(&self, place: Place) -> String {
        let row = place.row.map(|row| self.rows[row].name.as_str());
        let column = place.column.map(|column| self.columns[column].name.as_str());
        [column, row].into_iter().flatten().collect::<Vec<_>>().join(" of ")
    }

    /// Bars whose parts are shares of the table's whole: a bar a row if the whole is a column, and the other way round. `shares` gives those of
    /// a cell, ours and the paper's.
    fn stacks(&self, shares: impl Fn(usize, usize) -> [Option<f64>; 2]) -> Vec<Stack> {
        let across = match self.share_of {
            Some(Place { row: Some(_), column: None }) => true,
            Some(Place { row: None, column: Some(_) }) => false,
            _ => return Vec::new(),
        };
        let (bars, parts) = if across { (&self.columns, &self.rows) } else { (&self.rows, &self.columns) };
        let whole = self.share_of.and_then(|whole| if across { whole.row } else { whole.column });
        let stack = |bar: usize| {
            let place = |part: usize| if across { (part, bar) } else { (bar, part) };
            let is_part = |part: &usize| {
                let (row, column) = place(*part);
                !parts[*part].own
                    && !parts[*part].sum
                    && Some(*part) != whole
                    && matches!(self.measure(row, column).what, What::Time { .. })
            };
            let part = |part: usize| {
                let (row, column) = place(part);
                let [share, published_share] = shares(row, column);
                Part { name: parts[part].name.clone(), share, published_share }
            };
            Stack { name: bars[bar].name.clone(), parts: (0..parts.len()).filter(is_part).map(part).collect() }
        };
        let stacks = (0..bars.len()).filter(|bar| !bars[*bar].own).map(stack);
        stacks.filter(|stack| !stack.parts.is_empty()).collect()
    }

    /// Every cell's row and column, row by row.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let columns = self.columns.len();
        (0..self.rows.len()).flat_map(move |row| (0..columns).map(move |column| (row, column)))
    }
}

impl What {
    /// The measure in words: `time of gather`.
    pub fn label(&self) -> String {
        match self {
            Self::Time { of } => format!("time of {of}"),
            Self::Ratio { .. } => "ratio".to_owned(),
            Self::Error { figure, layer, .. } => format!("{} of {layer}", figure.name()),
            Self::Flicker { layer } => format!("flicker of {}", layer.name()),
            Self::Count { of } => format!("count {of}"),
            Self::Memory { of } => format!("memory of {of}"),
        }
    }

    pub fn unit(&self) -> &'static str {
        match self {
            Self::Time { .. } => "ms",
            Self::Ratio { .. } => "x",
            Self::Memory { .. } => "bytes",
            Self::Error { .. } | Self::Flicker { .. } | Self::Count { .. } => "",
        }
    }
}
