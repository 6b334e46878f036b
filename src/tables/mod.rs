//! Tables: sweeps over configs, measured cell by cell, beside the figures that a paper publishes.
//!
//! A table is a TOML file ([`read`]). Every cell's config is the table's base with what the table, the cell's row and its column
//! set; cells of the same config share one run ([`plan`]). A run leaves in its folder what `manylight render` leaves, and the
//! cells are worked out from these folders alone ([`cells`]), so that a sweep can be stopped, resumed, and split over machines.

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

/// A table as its file says it. Every row has as many cells as there are columns.
pub struct Table {
    /// Of the file, without its ending.
    pub name: String,
    pub title: String,
    /// Paper and table that it reproduces.
    pub source: Option<String>,
    pub about: Option<String>,
    /// What a reader must know of where this departs from the paper, or of how far to trust it.
    pub deviations: Vec<String>,
    pub published: Option<Published>,
    pub reference: ReferenceGoal,
    /// Whether the cells' pictures are put side by side, in `sheet.png`.
    pub sheet: bool,
    pub rows: Vec<Line>,
    pub columns: Vec<Line>,
    /// What cells measure where neither row nor column says.
    measure: Option<Measure>,
    /// Time cells are also given as ratios to this one.
    relative_to: Option<Place>,
    base: crate::config::Base,
    set: Option<Node>,
    /// The scene that the base's stands for, where it is to be had.
    original: Option<Node>,
}

/// A row or a column.
pub struct Line {
    pub name: String,
    /// A part of a config that its cells lay over the table's.
    set: Option<Node>,
    measure: Option<Measure>,
    /// Not in the paper.
    pub own: bool,
    origin: Origin,
}

/// What a paper published.
#[derive(Debug, Clone, PartialEq)]
pub struct Published {
    pub hardware: Option<String>,
    pub scene: Option<String>,
    pub settings: Option<String>,
    /// Row by row; `None` where the paper has no figure.
    pub figures: Vec<Vec<Option<f64>>>,
}

/// How good the truth must be that errors are measured against.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceGoal {
    /// Bounces of indirect light.
    pub bounces: u32,
    /// Relative standard error at which it is good enough.
    pub error: f64,
    /// Paths a pixel at most.
    pub samples: u32,
    /// Bounded at short distances as VPLs are, by `gather.min_distance`.
    pub min_distance: bool,
    /// Through the pixels' centres alone, as the rasterizer sees.
    pub centers: bool,
}

impl Default for ReferenceGoal {
    fn default() -> Self {
        Self { bounces: 1, error: 0.01, samples: 4096, min_distance: true, centers: true }
    }
}

/// What a cell says.
#[derive(Debug, Clone)]
pub struct Measure {
    pub what: What,
    origin: Origin,
}

#[derive(Debug, Clone, PartialEq)]
pub enum What {
    /// Median milliseconds of a stage, of a pass, of several added up (`gather+filter`), or of the whole frame (`frame`).
    Time { of: String },
    /// Of two other cells' values.
    Ratio { of: Place, over: Place },
    /// How far a layer is from the truth or from another cell's.
    Error { figure: Figure, layer: LayerPair, against: Against },
    /// How much a layer flickers over the config's frames: the temporal image difference.
    Flicker { layer: Intensity },
    /// What a pass counted in the last frame.
    Count { of: String },
    /// Bytes of the frame's own resources: of a stage, of a resource, or of all (`frame`).
    Memory { of: String },
}

/// A figure of [`crate::metrics::Measures`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Figure {
    Rmse,
    Relmse,
    Energy,
    Worst,
    Flip,
}

impl Figure {
    pub const ALL: [(&'static str, Self); 5] =
        [("rmse", Self::Rmse), ("relmse", Self::Relmse), ("energy", Self::Energy), ("worst", Self::Worst), ("flip", Self::Flip)];

    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, figure)| *figure == self).map_or("", |(name, _)| name)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub enum Against {
    Reference,
    Cell(Place),
}

/// A cell of the same table, by the names' numbers; what is absent is the asking cell's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Place {
    pub row: Option<usize>,
    pub column: Option<usize>,
}

impl Place {
    /// The cell that it means to one that asks.
    pub fn from(self, row: usize, column: usize) -> (usize, usize) {
        (self.row.unwrap_or(row), self.column.unwrap_or(column))
    }
}

impl Table {
    /// What a cell measures.
    pub fn measure(&self, row: usize, column: usize) -> &Measure {
        let own = self.columns[column].measure.as_ref().or(self.rows[row].measure.as_ref());
        own.or(self.measure.as_ref()).unwrap_or_else(|| unreachable!("a table without a measure for a cell is refused"))
    }

    /// Every cell's row and column, row by row.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let columns = self.columns.len();
        (0..self.rows.len()).flat_map(move |row| (0..columns).map(move |column| (row, column)))
    }
}

impl What {
    /// As a reader is told: `time of gather`.
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
