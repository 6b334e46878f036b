//! Cells of a table from the folders of its runs.

use super::folders::{IMAGE, RECORD, TIMINGS, WALKS, is_done, read_json, reference_folder, run_folder};
use super::plan::{Plan, Run};
use super::{Against, Figure, Place, Stack, Table, What};
use crate::fail;
use crate::files::write_file;
use crate::metrics::{self, ImageFile, LayerPair, Measures};
use crate::report::{Device, Statistics};
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A cell's value, with its unit, statistics and origin.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cell {
    /// The measure in words.
    pub measure: String,
    /// `ms`, `x` (a ratio), `bytes`, or empty.
    pub unit: &'static str,
    /// The value; `None` if there is none, for the reason in `why`.
    pub value: Option<f64>,
    /// 5th and 95th percentile over the frames; only for times.
    pub p5: Option<f64>,
    pub p95: Option<f64>,
    /// Standard deviation over the seeds; only for means of several.
    pub spread: Option<f64>,
    /// Number of frames that a time is the median of, or of seeds that a value is the mean of.
    pub n: Option<u64>,
    /// The paper's figure.
    pub published: Option<f64>,
    /// Share that our time is of the whole that the table names.
    pub share: Option<f64>,
    /// Share that the paper's time is of its own whole.
    pub published_share: Option<f64>,
    /// Ratio of our figure to that of the cell that the table names.
    pub relative: Option<f64>,
    /// Ratio of the paper's figure to its own of that cell.
    pub published_relative: Option<f64>,
    /// Keys of the run and its reference, the names of their folders.
    pub run: Option<String>,
    pub reference: Option<String>,
    /// Reason for a missing value.
    pub why: Option<String>,
}

/// A table's cells and their origin, the content of `table.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Results {
    pub kind: &'static str,
    pub name: String,
    pub title: String,
    pub source: Option<String>,
    pub about: Option<String>,
    pub version: String,
    pub device: Option<Device>,
    pub timing_mode: Option<String>,
    pub scale: f64,
    pub quick: bool,
    pub sets: Vec<String>,
    /// Whether all runs are done.
    pub complete: bool,
    /// The paper's hardware, scene and settings.
    pub published: Value,
    /// Cells that shares and ratios are of, in words.
    pub share_of: Option<String>,
    pub relative_to: Option<String>,
    /// Shares that make up a whole.
    pub stacks: Vec<Stack>,
    pub deviations: Vec<String>,
    pub rows: Vec<String>,
    pub columns: Vec<String>,
    /// Cells, row by row.
    pub cells: Vec<Vec<Cell>>,
    /// Scenes of the runs with their triangles, in words.
    pub scenes: Vec<String>,
    /// Warnings of the runs, each once.
    pub warnings: Vec<String>,
    /// Runs by key, with their labels and differing keys.
    pub runs: BTreeMap<String, Value>,
    pub references: Vec<String>,
    /// The largest standard error of the references over their mean, if it is over what the table asks for, and that.
    pub reference_error: Option<[f64; 2]>,
}

/// Computes all cells.
///
/// # Errors
/// `BadInput` for a damaged file of a run, and for runs of different devices, timing modes, versions or shaders.
pub fn results(table: &Table, plan: &Plan, folder: &Path) -> Result<Results> {
    let mut records = BTreeMap::new();
    for run in plan.runs.iter().filter(|run| is_done(folder, run)) {
        records.insert(run.key.as_str(), read_json(&run_folder(folder, run).join(RECORD))?);
    }
    let origin = origin(folder, &records)?;
    let mut scenes: Vec<String> = plan.runs.iter().filter_map(|run| scene_of(records.get(run.key.as_str())?)).collect();
    let warned = |record: &Value| {
        let list = record["warnings"].as_array().cloned().unwrap_or_default();
        list.into_iter().filter_map(|warning| warning.as_str().map(str::to_owned)).collect::<Vec<_>>()
    };
    let mut warnings: Vec<String> = plan.runs.iter().filter_map(|run| records.get(run.key.as_str())).flat_map(warned).collect();
    for list in [&mut scenes, &mut warnings] {
        let mut seen = std::collections::BTreeSet::new();
        list.retain(|line| seen.insert(line.clone()));
    }
    let mut source = Source { table, plan, folder, records, compared: BTreeMap::new() };
    let mut cells: Vec<Vec<Cell>> = Vec::new();
    for row in 0..table.rows.len() {
        cells.push((0..table.columns.len()).map(|column| source.cell(row, column)).collect::<Result<_>>()?);
    }
    // Times of ours and of the paper's, each over the time of another cell.
    let over = |cells: &[Vec<Cell>], place: Option<Place>, (row, column): (usize, usize)| {
        let (of_row, of_column) = place?.from(row, column);
        let (cell, base) = (&cells[row][column], &cells[of_row][of_column]);
        let ratio = |value: Option<f64>, base: Option<f64>| Some(value? / base.filter(|base| *base > 0.0)?);
        // Ratios of other figures mean something where the paper has them.
        let is_time = [cell, base].iter().all(|cell| cell.unit == "ms");
        let is_error = cell.published.is_some() && !["ms", "x"].contains(&cell.unit) && cell.measure == base.measure;
        (is_time || is_error).then(|| [ratio(cell.value, base.value), ratio(cell.published, base.published)])
    };
    for (row, column) in table.places() {
        let shares = over(&cells, table.share_of, (row, column)).unwrap_or_default();
        let ratios = over(&cells, table.relative_to, (row, column)).unwrap_or_default();
        let cell = &mut cells[row][column];
        [cell.share, cell.published_share] = shares;
        [cell.relative, cell.published_relative] = ratios;
    }
    let stacks = table.stacks(|row, column| [cells[row][column].share, cells[row][column].published_share]);
    let published = table.published.as_ref().map_or(
        Value::Null,
        |published| json!({ "hardware": published.hardware, "scene": published.scene, "settings": published.settings }),
    );
    let references = plan.runs.iter().filter(|run| run.needs_reference).map(|run| run.reference_key(table));
    let references: std::collections::BTreeSet<String> = references.filter(|key| reference_folder(folder, key).is_dir()).collect();
    let error_of =
        |key: &String| read_json(&reference_folder(folder, key).join(RECORD)).ok()?["checks"]["relative-standard-error"].as_f64();
    let reference_error = references.iter().filter_map(error_of).reduce(f64::max);
    let reference_error = reference_error.filter(|error| *error > table.reference.error).map(|error| [error, table.reference.error]);
    let run = |run: &Run| {
        let [width, height] = run.config.frame.size;
        (run.key.clone(), json!({ "label": run.label, "set": run.set, "width": width, "height": height }))
    };
    Ok(Results {
        kind: "table",
        name: table.name.clone(),
        title: table.title.clone(),
        source: table.source.clone(),
        about: table.about.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        device: origin.as_ref().map(|origin| origin.0.clone()),
        timing_mode: origin.map(|origin| origin.1),
        scale: plan.sweep.scale,
        quick: plan.sweep.quick,
        sets: plan.sweep.sets.clone(),
        complete: plan.runs.iter().all(|run| is_done(folder, run)),
        published,
        share_of: table.share_of.map(|place| table.named(place)),
        relative_to: table.relative_to.map(|place| table.named(place)),
        stacks,
        deviations: table.deviations.clone(),
        rows: table.rows.iter().map(|line| line.name.clone()).collect(),
        columns: table.columns.iter().map(|line| line.name.clone()).collect(),
        cells,
        scenes,
        warnings,
        runs: plan.runs.iter().map(run).collect(),
        references: references.into_iter().collect(),
        reference_error,
    })
}

/// Scene of a run in words, with its triangles.
fn scene_of(record: &Value) -> Option<String> {
    let scene = &record["config"]["scene"];
    let name = match scene["file"].as_str() {
        Some(file) => Path::new(file).file_name()?.to_string_lossy().into_owned(),
        None => format!("built-in {}", scene["builtin"].as_str()?),
    };
    let triangles = record["counts"]["scene/triangles"].as_u64();
    Some(triangles.map_or_else(|| name.clone(), |triangles| format!("{name} ({} triangles)", in_thousands(triangles))))
}

/// A number with commas.
fn in_thousands(number: u64) -> String {
    let digits = number.to_string();
    let groups: Vec<&str> = digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join(",")
}

/// Device and timing mode of the runs, which must agree in these, in version and in shaders.
fn origin(folder: &Path, records: &BTreeMap<&str, Value>) -> Result<Option<(Device, String)>> {
    let mut found: Option<(&str, [&Value; 4])> = None;
    for (key, record) in records {
        let own = ["device", "timing_mode", "version", "shaders"].map(|what| &record[what]);
        match found {
            Some((other, of_other)) if of_other != own => {
                return Err(fail!(
                    BadInput,
                    "{}: runs {other} and {key} come from different devices, timing modes, versions or shaders, whose figures do not go into one table; remove one of them",
                    folder.display()
                ));
            }
            _ => found = Some((key, own)),
        }
    }
    let Some((key, [device, mode, ..])) = found else { return Ok(None) };
    let text = |name: &str| device[name].as_str().map(str::to_owned);
    let read = || {
        let device = Device { name: text("name")?, kind: text("kind")?, driver: text("driver")?, driver_version: text("driver_version")? };
        Some((device, mode.as_str()?.to_owned()))
    };
    read().map(Some).ok_or_else(|| {
        fail!(BadInput, "{}: run {key} has a {RECORD} that does not say on which device it ran; remove it", folder.display())
    })
}

struct Source<'t> {
    table: &'t Table,
    plan: &'t Plan,
    folder: &'t Path,
    records: BTreeMap<&'t str, Value>,
    /// Comparisons made so far, since several figures come from each.
    compared: BTreeMap<(PathBuf, PathBuf, String), Measures>,
}

/// A value, or the reason for its lack.
type Found = std::result::Result<f64, String>;

impl Source<'_> {
    fn cell(&mut self, row: usize, column: usize) -> Result<Cell> {
        let what = self.table.measure(row, column).what.clone();
        let mut cell = Cell {
            measure: what.label(),
            unit: what.unit(),
            value: None,
            p5: None,
            p95: None,
            spread: None,
            n: None,
            published: self.table.published.as_ref().and_then(|published| published.figures[row][column]),
            share: None,
            published_share: None,
            relative: None,
            published_relative: None,
            run: None,
            reference: None,
            why: None,
        };
        let seeds = self.table.measure(row, column).seeds as usize;
        // The first seed's folders stand in the cell.
        let mut found = self.found(&what, row, column, 0, &mut cell)?;
        if seeds > 1
            && let Ok(first) = found
        {
            let mut values = vec![first];
            for seed in 1..seeds {
                match self.found(&what, row, column, seed, &mut cell.clone())? {
                    Ok(value) => values.push(value),
                    Err(why) => found = Err(format!("seed {seed}: {why}")),
                }
            }
            if found.is_ok() {
                let mean = values.iter().sum::<f64>() / seeds as f64;
                let squares = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
                (cell.spread, cell.n) = (Some((squares / (seeds - 1) as f64).sqrt()), Some(seeds as u64));
                found = Ok(mean);
            }
        }
        match found {
            Ok(value) if value.is_finite() => cell.value = Some(value),
            Ok(_) => cell.why = Some("not a finite number".to_owned()),
            Err(why) => cell.why = Some(why),
        }
        Ok(cell)
    }

    fn found(&mut self, what: &What, row: usize, column: usize, seed: usize, cell: &mut Cell) -> Result<Found> {
        if let What::Ratio { of, over } = what {
            let (mut values, mut units) = ([0.0; 2], [""; 2]);
            for ((value, of_unit), place) in values.iter_mut().zip(&mut units).zip([of, over]) {
                let (row, column) = place.from(row, column);
                match self.cell(row, column)? {
                    Cell { value: Some(found), unit, .. } => (*value, *of_unit) = (found, unit),
                    Cell { why, .. } => return Ok(Err(why.unwrap_or_default())),
                }
            }
            // VPLs a pixel are no factor.
            if units == [""; 2] {
                cell.unit = "";
            }
            return Ok(Ok(values[0] / values[1]));
        }
        let (table, plan) = (self.table, self.plan);
        let run = plan.seed(row, column, seed);
        cell.run = Some(run.key.clone());
        let Some(record) = self.records.get(run.key.as_str()) else { return Ok(Err("its run is missing".to_owned())) };
        let own = run_folder(self.folder, run);
        Ok(match what {
            What::Time { of } if of.contains('+') => match sum_of_times(&own.join(TIMINGS), of)? {
                Ok(time) => {
                    (cell.p5, cell.p95, cell.n) = (Some(time.p5), Some(time.p95), Some(time.n as u64));
                    Ok(time.median)
                }
                Err(missing) => Err(format!("the frame has no {missing}")),
            },
            What::Time { of } => {
                let Some(time) = timed(&record["timings"], of) else { return Ok(Err(format!("the frame has no {of}"))) };
                (cell.p5, cell.p95, cell.n) = (time["p5"].as_f64(), time["p95"].as_f64(), time["n"].as_u64());
                time["median"].as_f64().ok_or_else(|| "not timed".to_owned())
            }
            What::Count { of } => record["counts"][of].as_f64().ok_or_else(|| format!("no pass counts {of}")),
            What::Memory { of } => memory(&record["memory"], of).ok_or_else(|| format!("the frame has no {of}")),
            What::Flicker { layer } => {
                let walks = read_json(&own.join(WALKS))?;
                walks[layer.name()].as_f64().ok_or_else(|| format!("the flicker of {} was not measured", layer.name()))
            }
            What::Error { figure, layer, against } => {
                let other = match against {
                    Against::Reference => {
                        let key = run.reference_key(table);
                        cell.reference = Some(key.clone());
                        reference_folder(self.folder, &key)
                    }
                    Against::Cell(place) => {
                        let (row, column) = place.from(row, column);
                        run_folder(self.folder, plan.seed(row, column, seed))
                    }
                };
                if !other.join(RECORD).is_file() {
                    return Ok(Err("the run that it is measured against is missing".to_owned()));
                }
                let key = (own.join(IMAGE), other.join(IMAGE), layer.to_string());
                if !self.compared.contains_key(&key) {
                    let measures = compare(&key.0, &key.1, layer)?;
                    self.compared.insert(key.clone(), measures);
                }
                figure_of(&self.compared[&key], *figure).ok_or_else(|| format!("{layer} has no {}", figure.name()))
            }
            What::Ratio { .. } => unreachable!("ratios are of cells"),
        })
    }
}

fn timed<'v>(timings: &'v Value, of: &str) -> Option<&'v Value> {
    if of == "frame" {
        return Some(&timings["total"]).filter(|total| total.is_object());
    }
    let list = &timings[if of.contains('/') { "passes" } else { "stages" }];
    list.as_array()?.iter().find(|row| row["name"] == of)
}

/// The first columns of a line of `timings.csv`.
#[derive(Deserialize)]
struct TimingRow {
    frame: u32,
    pass: String,
    stage: String,
    ms: f64,
}

/// Statistics of stages and passes (`gather+filter`) summed frame by frame; or the first of them that the run lacks.
fn sum_of_times(path: &Path, of: &str) -> Result<std::result::Result<Statistics, String>> {
    // A part with a question mark may be missing from a frame, as long as another is there.
    let (parts, optional): (Vec<&str>, Vec<bool>) = of.split('+').map(|part| (part.trim_end_matches('?'), part.ends_with('?'))).unzip();
    let mut seen = vec![false; parts.len()];
    let mut frames: BTreeMap<u32, f64> = BTreeMap::new();
    let damaged = || format!("{}: is damaged; remove its folder to run it again", path.display());
    let mut reader = csv::Reader::from_path(path).with_context(damaged)?;
    for row in reader.deserialize() {
        let row: TimingRow = row.with_context(damaged)?;
        for (_, seen) in parts.iter().zip(&mut seen).filter(|(part, _)| **part == row.pass || **part == row.stage) {
            *seen = true;
            *frames.entry(row.frame).or_default() += row.ms;
        }
    }
    let missing = |i: &usize| !seen[*i] && (!optional[*i] || !seen.contains(&true));
    if let Some(missing) = (0..parts.len()).find(missing) {
        return Ok(Err(parts[missing].to_owned()));
    }
    let sums: Vec<f64> = frames.into_values().collect();
    Statistics::of(&sums).map(Ok).with_context(damaged)
}

fn memory(memory: &Value, of: &str) -> Option<f64> {
    if of == "frame" {
        return memory["stages"].as_object().map(|stages| stages.values().filter_map(Value::as_f64).sum());
    }
    memory[if of.contains('/') { "resources" } else { "stages" }][of].as_f64()
}

fn compare(test: &Path, reference: &Path, layer: &LayerPair) -> Result<Measures> {
    let of = |path: &Path, names: &[String]| ImageFile::open(path)?.layer(names);
    let compared = metrics::compare(&of(test, &layer.test)?, &of(reference, &layer.reference)?);
    Ok(compared.with_context(|| format!("{} and {}: layer {layer}", test.display(), reference.display()))?.measures)
}

fn figure_of(measures: &Measures, figure: Figure) -> Option<f64> {
    match figure {
        Figure::Rmse => Some(measures.rmse),
        Figure::Mae => Some(measures.mae),
        Figure::Relmse => Some(measures.relmse),
        Figure::Energy => measures.energy,
        Figure::Worst => Some(measures.worst),
        Figure::Flip => measures.flip,
    }
}

impl Results {
    /// Writes `table.json`, `table.md` and `table.csv`.
    pub fn write(&self, folder: &Path) -> Result<()> {
        let mut json = serde_json::to_vec_pretty(self).context("table.json cannot be put together")?;
        json.push(b'\n');
        write_file(&folder.join("table.json"), &json)?;
        write_file(&folder.join("table.md"), super::print::markdown(self).as_bytes())?;
        write_file(&folder.join("table.csv"), &super::print::csv(self)?)
    }
}
