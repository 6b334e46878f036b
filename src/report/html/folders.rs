//! Reading the folders of a report.

use super::files::{Record, json};
use super::flicker::Flicker;
use super::table::TableFile;
use crate::fail;
use anyhow::Result;
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

/// A render or a reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    pub folder: PathBuf,
    /// Label in the report.
    pub label: String,
    pub record: Record,
}

impl Run {
    /// Name of the folder, the run's key in a table.
    pub fn key(&self) -> String {
        self.folder.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// Paths per pixel of a reference; `None` for a render.
    pub fn samples(&self) -> Option<u64> {
        self.record.counts.get("reference/samples").copied()
    }

    /// The picture to show, if there is one.
    pub fn picture(&self) -> Option<PathBuf> {
        Some(self.folder.join("image.png")).filter(|path| path.is_file())
    }

    /// The file of layers to measure errors on, if there is one.
    pub fn layers(&self) -> Option<PathBuf> {
        Some(self.folder.join("image.exr")).filter(|path| path.is_file())
    }
}

/// Runs of one table, or those given one by one, and their references.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Group {
    pub table: Option<TableFile>,
    pub runs: Vec<Run>,
    pub references: Vec<Run>,
    pub flickers: Vec<Flicker>,
    /// Keys of the table's runs and references whose folders are missing.
    pub missing: Vec<String>,
}

/// Reads folders: a group for each table, then one of all other runs, if there are any. A folder given twice counts once.
///
/// # Errors
/// `BadInput` with the folder or the file: a folder without anything to report, one that cannot be read, or a second table of
/// the same name.
pub fn read(folders: &[PathBuf]) -> Result<Vec<Group>> {
    let mut seen = BTreeSet::new();
    let mut groups: Vec<Group> = Vec::new();
    let mut single = Group::default();
    for folder in folders {
        let real = folder.canonicalize().map_err(|error| fail!(BadInput, "{}: cannot be read ({error})", folder.display()))?;
        if !seen.insert(real.clone()) {
            continue;
        }
        if !folder.join("table.json").is_file() {
            // The canonical path gives "." and ".." a name too.
            let label = real.file_name().unwrap_or(real.as_os_str()).to_string_lossy().into_owned();
            if !single.take(folder, label)? {
                return Err(nothing(folder));
            }
            continue;
        }
        let group = table(folder)?;
        if let Some(name) = group.name().filter(|_| groups.iter().any(|other| other.name() == group.name())) {
            return Err(fail!(BadInput, "{}: is a second table of the name {name}; give one of them", folder.display()));
        }
        groups.push(group);
    }
    single.tell_apart();
    if !single.is_empty() {
        groups.push(single);
    }
    Ok(groups)
}

fn nothing(folder: &Path) -> anyhow::Error {
    let below = std::fs::read_dir(folder).into_iter().flatten().flatten().any(|entry| is_known(&entry.path()));
    let remedy = if below { "give the folders in it" } else { "give folders that render, reference or reproduce wrote" };
    fail!(BadInput, "{}: has no run.json, table.json or flicker.json; {remedy}", folder.display())
}

fn is_known(folder: &Path) -> bool {
    ["run.json", "table.json", "flicker.json"].iter().any(|name| folder.join(name).is_file())
}

impl Group {
    /// Name of the group's table.
    fn name(&self) -> Option<&str> {
        self.table.as_ref().map(|table| table.name.as_str())
    }

    fn is_empty(&self) -> bool {
        self.runs.is_empty() && self.references.is_empty() && self.flickers.is_empty()
    }

    /// Adds the content of a folder; false if there is none.
    fn take(&mut self, folder: &Path, label: String) -> Result<bool> {
        let record: Option<Record> = json(&folder.join("run.json"))?;
        let flicker = Flicker::read(&folder.join("flicker.json"), &label, record.as_ref())?;
        let found = record.is_some() || flicker.is_some();
        self.flickers.extend(flicker);
        if let Some(record) = record {
            let run = Run { folder: folder.to_owned(), label, record };
            if run.samples().is_some() { self.references.push(run) } else { self.runs.push(run) }
        }
        Ok(found)
    }

    /// Extends equal labels by as much of their paths as makes them distinct.
    fn tell_apart(&mut self) {
        let all: Vec<(PathBuf, String)> =
            self.runs.iter().chain(&self.references).map(|run| (run.folder.clone(), run.label.clone())).collect();
        let mut names = all.iter().map(|(folder, label)| {
            let twins: Vec<&PathBuf> = all.iter().filter(|(_, other)| other == label).map(|(folder, _)| folder).collect();
            if twins.len() == 1 { label.clone() } else { shortest(folder, &twins) }
        });
        for run in self.runs.iter_mut().chain(&mut self.references) {
            run.label = names.next().unwrap_or_default();
        }
    }
}

/// The shortest end of a path that no other of these paths has.
fn shortest(folder: &Path, twins: &[&PathBuf]) -> String {
    let parts: Vec<Component> = folder.components().collect();
    let end = |count: usize| parts[parts.len() - count..].iter().collect::<PathBuf>();
    let alone = |count: &usize| twins.iter().filter(|twin| twin.ends_with(end(*count))).count() == 1;
    end((1..=parts.len()).find(alone).unwrap_or(parts.len())).display().to_string()
}

/// A table, with its runs and references.
fn table(folder: &Path) -> Result<Group> {
    let path = folder.join("table.json");
    let Some(table): Option<TableFile> = json(&path)? else { unreachable!("the file was there") };
    table.check(&path)?;
    let mut group = Group::default();
    // Runs are in the order of their cells; runs that no cell names come last.
    let named: Vec<&str> = table.cells.iter().flatten().filter_map(|cell| cell.run.as_deref()).collect();
    let mut in_order: Vec<_> = table.runs.iter().collect();
    in_order.sort_by_key(|(key, _)| named.iter().position(|name| name == key).unwrap_or(usize::MAX));
    let runs = in_order.into_iter().map(|(key, run)| ("runs", key, run.label.as_str()));
    let references = table.references.iter().map(|key| ("references", key, key.as_str()));
    for (place, key, label) in runs.chain(references) {
        // A key must be a plain folder name, so that it cannot lead out of the table's folder.
        if !matches!(Path::new(key).components().collect::<Vec<_>>().as_slice(), [Component::Normal(_)]) {
            return Err(fail!(BadInput, "{}: {key:?} cannot be the name of a run's folder", path.display()));
        }
        let label = if label.is_empty() { key } else { label };
        if !group.take(&folder.join(place).join(key), label.to_owned())? {
            group.missing.push(key.clone());
        }
    }
    Ok(Group { table: Some(table), ..group })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::{Exit, exit_code};
    use serde_json::{Value, json};
    use std::fs;

    pub fn run_json(counts: &Value) -> Value {
        json!({
            "version": "0.1.0", "preset": "p", "timing_mode": "isolated", "width": 4, "height": 3, "counts": counts,
            "device": { "name": "d", "kind": "cpu", "driver": "e", "driver_version": "1" },
        })
    }

    fn write(path: &Path, json: &Value) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, json.to_string()).unwrap();
    }

    fn table_json(name: &str) -> Value {
        let mut table = run_json(&json!({}));
        let more = json!({
            "kind": "table", "name": name, "title": "T", "rows": ["a"], "columns": ["b"], "cells": [[{ "value": 1 }]],
            "runs": { "k1": { "label": "first", "set": {} } }, "references": ["r1"],
        });
        table.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        table
    }

    #[test]
    fn folders_are_told_apart_by_what_they_hold() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        write(&at("a/run.json"), &run_json(&json!({ "vpls/count": 3 })));
        write(&at("truth/run.json"), &run_json(&json!({ "reference/samples": 16 })));
        write(&at("table/table.json"), &table_json("t"));
        write(&at("table/runs/k1/run.json"), &run_json(&json!({})));
        write(&at("flicker/flicker.json"), &json!({ "pairs": [{ "frame": 0, "rms": 0.5 }] }));
        let groups = read(&[at("a"), at("truth"), at("table"), at("flicker"), at("a")]).unwrap();
        let labels = |runs: &[Run]| runs.iter().map(|run| run.label.clone()).collect::<Vec<_>>();
        assert_eq!(groups.len(), 2);
        assert_eq!((labels(&groups[0].runs), groups[0].missing.clone()), (vec!["first".to_owned()], vec!["r1".to_owned()]));
        assert_eq!(labels(&groups[1].runs), ["a"], "given twice, there once");
        assert_eq!(labels(&groups[1].references), ["truth"]);
        assert_eq!(groups[1].flickers.len(), 1);
    }

    #[test]
    fn folders_of_the_same_name_are_called_by_more_of_their_paths() {
        let place = tempfile::tempdir().unwrap();
        let folders = ["x/out", "y/out", "z"].map(|name| place.path().join(name));
        for folder in &folders {
            write(&folder.join("run.json"), &run_json(&json!({})));
        }
        let labels: Vec<String> = read(&folders).unwrap()[0].runs.iter().map(|run| run.label.clone()).collect();
        assert_eq!(labels, ["x/out", "y/out", "z"]);
    }

    #[test]
    fn what_is_no_input_is_refused_in_a_sentence() {
        let place = tempfile::tempdir().unwrap();
        let at = |name: &str| place.path().join(name);
        fs::create_dir(at("empty")).unwrap();
        write(&at("above/run/run.json"), &run_json(&json!({})));
        write(&at("broken/run.json"), &json!({ "version": 3 }));
        write(&at("one/table.json"), &table_json("t"));
        write(&at("two/table.json"), &table_json("t"));
        let mut away = table_json("t");
        away["references"] = json!(["../one"]);
        write(&at("away/table.json"), &away);
        let mut ragged = table_json("t");
        ragged["cells"] = json!([[]]);
        write(&at("ragged/table.json"), &ragged);
        for (folders, says) in [
            (vec!["gone"], "gone: cannot be read"),
            (vec!["empty"], "empty: has no run.json, table.json or flicker.json; give folders that render"),
            (vec!["above"], "above: has no run.json, table.json or flicker.json; give the folders in it"),
            (vec!["broken"], "run.json: is not what a report can read ("),
            (vec!["one", "two"], "two: is a second table of the name t"),
            (vec!["away"], "\"../one\" cannot be the name of a run's folder"),
            (vec!["ragged"], "table.json: row a has 0 cells, not 1"),
        ] {
            let error = read(&folders.into_iter().map(at).collect::<Vec<_>>()).unwrap_err();
            assert!(error.to_string().contains(says), "{error}");
            assert_eq!(exit_code(&error), Exit::BadInput);
        }
    }
}
