//! `manylight report`: one HTML file that shows runs, tables and errors against references.
//!
//! The file is self-contained: pictures are data: URIs, plots are SVG, and its content policy forbids all requests, and all
//! scripts and styles but its own. All text from files is escaped. The same folders give the same bytes.

mod axis;
mod errors;
mod files;
mod flicker;
mod folders;
mod group;
mod keys;
mod matching;
mod numbers;
mod page;
mod plot;
mod provenance;
mod record;
mod set;
mod stacks;
mod stages;
mod table;
mod table_view;

use crate::metrics::LayerPair;
use anyhow::Result;
use std::path::PathBuf;

/// The page for these folders; errors are measured on `layers`.
///
/// # Errors
/// `BadInput` with the folder or the file and its fault.
pub fn report(folders: &[PathBuf], layers: &LayerPair) -> Result<String> {
    page::render(&folders::read(folders)?, layers)
}

#[cfg(test)]
mod samples {
    use super::files::Record;
    use super::folders::Run;
    use crate::report::{Timings, samples::provenance};
    use serde_json::json;
    use std::path::PathBuf;

    /// A render without files.
    pub fn run(label: &str) -> Run {
        let config = json!({
            "scene": { "builtin": "cornell", "seed": 0 },
            "frame": { "size": [960, 540], "count": 5, "fps": 30.0 },
            "materials": { "dielectric": "lambert" },
            "vpls": { "count": 64 },
        });
        let record = Record {
            from: provenance(),
            timings: Timings::default(),
            counts: Default::default(),
            checks: Default::default(),
            warnings: Vec::new(),
            config,
        };
        Run { folder: PathBuf::from(label), label: label.to_owned(), record }
    }
}
