//! The reference of a table's run: traced once to its goal, and kept in the user's cache for other tables.

use super::progress::Progress;
use super::reference::frame::{Files, Goal};
use super::reference::{self, truth_identity};
use super::setup::{execution, provenance};
use crate::config::Config;
use crate::files::{prepare_folder, write_file};
use crate::reference::{Settings, load_sums};
use crate::renderer::Renderer;
use crate::report::timings_csv;
use crate::tables::ReferenceGoal;
use crate::tables::folders::reference_cache;
use anyhow::Result;
use std::path::Path;

/// A reference to provide.
pub struct Truth<'a> {
    pub config: &'a Config,
    /// [`crate::reference::scene_digest`] of the scene.
    pub digest: &'a str,
    pub goal: ReferenceGoal,
}

impl Truth<'_> {
    /// Provides the reference in `folder`: kept there, copied from the cache, or traced.
    pub fn bring(&self, renderer: &mut Renderer, folder: &Path, table: &str, progress: &Progress) -> Result<()> {
        let settings = Settings {
            bounces: self.goal.bounces,
            frame_index: self.config.frame.count - 1,
            min_distance: if self.goal.min_distance { self.config.gather.min_distance } else { 0.0 },
            centered: self.goal.centers,
        };
        let identity = truth_identity(renderer, self.config, settings, self.digest)?;
        // The goal is part of the key: a reference that another table refined would give other figures than the first time.
        let key = blake3::hash(format!("{identity} {} {}", self.goal.error, self.goal.samples).as_bytes()).to_hex();
        if is_of(folder, key.as_str()) {
            return Ok(());
        }
        let kept = reference_cache().map(|cache| cache.join(&key.as_str()[..32]));
        if let Some(kept) = kept.as_ref().filter(|kept| is_of(kept, key.as_str())) {
            return copy_folder(kept, folder);
        }
        prepare_folder(folder)?;
        let goal = Goal { spp: self.goal.samples, target_error: Some(self.goal.error), time: None };
        let execution = execution(self.config, renderer);
        let from = provenance(Path::new(table), self.config, renderer);
        let run = reference::frame::Run { goal, is_sequence: false, config: self.config, execution: &execution, progress, from };
        let files = Files { sums: folder.join(SUMS), exr: folder.join("image.exr"), png: folder.join("image.png") };
        let before = load_sums(&files.sums, &identity, self.config.frame.size, settings.bounces).ok();
        let traced = run.trace(renderer, settings, &identity, before.as_ref(), &files)?;
        write_file(&folder.join("timings.csv"), &timings_csv(&traced.times, &run.from)?)?;
        let mut record = run.record(renderer, settings, &traced)?;
        record.checks.insert(IDENTITY.to_owned(), key.as_str().into());
        record.write(&folder.join(LAST))?;
        // Sums only serve to continue, and are larger than all other files.
        let _ = std::fs::remove_file(&files.sums);
        if let Some(kept) = kept
            && let Err(error) = copy_folder(folder, &kept)
        {
            progress.warn(&format!("the reference is not kept for the next table: {error:#}"));
        }
        Ok(())
    }
}

/// Key of the reference in its record's checks.
const IDENTITY: &str = "identity";

/// Whether a folder holds the whole reference with this key.
fn is_of(folder: &Path, key: &str) -> bool {
    let record = std::fs::read(folder.join(LAST)).ok().and_then(|bytes| serde_json::from_slice::<serde_json::Value>(&bytes).ok());
    record.is_some_and(|record| record["checks"][IDENTITY] == key)
}

/// The record is written last: a folder that has one is complete.
const LAST: &str = "run.json";
const SUMS: &str = "sums.exr";

/// Copies a folder's files, each whole or not at all, the record last.
pub fn copy_folder(from: &Path, to: &Path) -> Result<()> {
    prepare_folder(to)?;
    let cannot = |error: std::io::Error| crate::fail!(BadInput, "{}: cannot be read ({error})", from.display());
    let mut names = std::fs::read_dir(from)
        .map_err(cannot)?
        .filter(|entry| entry.as_ref().is_ok_and(|entry| entry.path().is_file()))
        .map(|entry| Ok(entry?.file_name()))
        .collect::<std::io::Result<Vec<_>>>()
        .map_err(cannot)?;
    names.sort_by_key(|name| name == LAST);
    for name in names {
        let bytes = std::fs::read(from.join(&name)).map_err(cannot)?;
        crate::files::write_file(&to.join(&name), &bytes)?;
    }
    Ok(())
}
