//! Folders of a table's runs and references, and checks whether they are complete.

use super::Run;
use crate::{cache, fail};
use anyhow::Result;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Folder of a run, in its table's folder.
pub fn run_folder(folder: &Path, run: &Run) -> PathBuf {
    folder.join("runs").join(&run.key)
}

/// Folder of a reference, in its table's folder.
pub fn reference_folder(folder: &Path, key: &str) -> PathBuf {
    folder.join("references").join(key)
}

/// Removes a run's record, so that a run in progress does not count as done.
pub fn begin(folder: &Path, run: &Run) -> Result<()> {
    let record = run_folder(folder, run).join(RECORD);
    match std::fs::remove_file(&record) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(fail!(OutputNotWritten, "{}: cannot be removed ({error}); choose another folder", record.display()))
        }
        _ => Ok(()),
    }
}

/// Whether this version of the program has done the run, with the shaders of this key.
pub fn is_current(folder: &Path, run: &Run, shaders: &str) -> bool {
    let record = read_json(&run_folder(folder, run).join(RECORD));
    record.is_ok_and(|record| record["version"] == env!("CARGO_PKG_VERSION") && record["shaders"] == shaders)
}

/// Whether a run is complete: its record, which is written last, exists.
pub fn is_done(folder: &Path, run: &Run) -> bool {
    run_folder(folder, run).join(RECORD).is_file()
}

/// File of a run's flicker figures, by layer, beside its record.
pub const WALKS: &str = "walks.json";
/// Files of a run: its record, its picture and its times.
pub const RECORD: &str = "run.json";
pub const IMAGE: &str = "image.exr";
pub const TIMINGS: &str = "timings.csv";

/// Content of a JSON file of a run.
pub fn read_json(path: &Path) -> Result<Value> {
    let bytes = std::fs::read(path).map_err(|error| fail!(BadInput, "{}: cannot be read ({error})", path.display()))?;
    serde_json::from_slice(&bytes).map_err(|error| fail!(BadInput, "{}: is damaged ({error}); remove it to run it again", path.display()))
}

/// Folder of references kept for all tables.
pub fn reference_cache() -> Option<PathBuf> {
    cache::user().folder().map(|folder| folder.join("references"))
}
