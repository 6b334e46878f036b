//! Planning of a table: its distinct runs, and the run of each cell.

use super::{Against, Table, What};
use crate::config::check::error;
use crate::config::tree::quoted;
use crate::config::{Config, nearest, to_toml};
use crate::metrics::Intensity;
use anyhow::{Context, Result};
use std::collections::{BTreeMap, BTreeSet};

/// A user's changes to a whole table. The results record them all.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    /// Factor on both sides of every picture.
    pub scale: f64,
    /// Whether runs have few frames.
    pub quick: bool,
    /// `--set` options, applied to every cell.
    pub sets: Vec<String>,
}

impl Default for Sweep {
    fn default() -> Self {
        Self { scale: 1.0, quick: false, sets: Vec::new() }
    }
}

/// Frames of a quick run, and of a quick camera path.
const QUICK: u32 = 3;
const QUICK_WALK: u32 = 6;

/// A config, rendered once for all cells that share it.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Name of its folder: a hash of the config, with the scene's file name but not its folder, so that it is the same on all
    /// machines.
    pub key: String,
    /// Its first cell's row and column, as far as rows or columns have settings.
    pub label: String,
    pub config: Config,
    /// The keys that differ from run to run, as TOML.
    pub set: BTreeMap<String, String>,
    /// Layers whose flicker over all frames is measured.
    pub walks: BTreeMap<&'static str, Intensity>,
    /// Whether any error is measured against the reference.
    pub needs_reference: bool,
}

impl Run {
    /// The config that the run's reference is traced with: seeds share a truth.
    pub fn truth(&self) -> Config {
        let mut config = self.config.clone();
        config.frame.seed = 0;
        config
    }

    /// Folder name of the reference for this run.
    pub fn reference_key(&self, table: &Table) -> String {
        let mut config = Config { camera: self.config.camera.clone(), light: self.config.light.clone(), ..Config::default() };
        config.scene = self.config.scene.clone();
        config.materials = self.config.materials.clone();
        (config.frame.size, config.frame.count, config.frame.fps) =
            (self.config.frame.size, self.config.frame.count, self.config.frame.fps);
        let goal = table.reference;
        // `gather.min_distance` is the only key of the methods that a clamped reference depends on.
        config.gather.min_distance = if goal.min_distance { self.config.gather.min_distance } else { 0.0 };
        hash(&format!("{goal:?} {}", portable(&config)))
    }
}

/// The distinct runs of a table, and the run of each cell.
pub struct Plan {
    pub runs: Vec<Run>,
    /// Indices of each cell's runs, one a seed, row by row; meaningless for a cell that needs none.
    of_cell: Vec<Vec<Vec<usize>>>,
    pub sweep: Sweep,
    /// What the user should be told of the cells' configs.
    pub warnings: Vec<String>,
}

impl Plan {
    /// Computes and checks all cells' configs.
    ///
    /// # Errors
    /// `BadInput` with file, line and key for a cell's bad config.
    pub fn of(table: &Table, sweep: &Sweep) -> Result<Self> {
        let mut all: Vec<Run> = Vec::new();
        let mut warnings = Vec::new();
        // A cell that others are measured against has as many seeds as they, or one picture for all if its own measure has no seeds.
        let mut seeds: Vec<Vec<u32>> = vec![vec![1; table.columns.len()]; table.rows.len()];
        for (row, column) in table.places() {
            let measure = table.measure(row, column);
            seeds[row][column] = seeds[row][column].max(measure.seeds);
            if let What::Error { against: Against::Cell(place), .. } = &measure.what {
                let (row, column) = place.from(row, column);
                if table.measure(row, column).seeds > 1 {
                    seeds[row][column] = seeds[row][column].max(measure.seeds);
                }
            }
        }
        let mut of_cell = vec![vec![Vec::new(); table.columns.len()]; table.rows.len()];
        for (row, column) in table.places() {
            let (of_row, of_column) = (&table.rows[row], &table.columns[column]);
            let sets: Vec<_> = [&table.original, &table.set, &of_row.set, &of_column.set].into_iter().flatten().collect();
            let walks = matches!(table.measure(row, column).what, What::Flicker { .. });
            let loaded = table.base.with(&sets, &sweep.sets);
            let loaded = loaded.with_context(|| format!("row {:?}, column {:?}", of_row.name, of_column.name))?;
            warnings.extend(loaded.warnings);
            let config = sweep.apply(loaded.config, walks);
            for seed in 0..seeds[row][column] {
                let mut config = config.clone();
                config.frame.seed = config.frame.seed.wrapping_add(seed);
                let key = hash(&portable(&config));
                let at = all.iter().position(|run| run.key == key).unwrap_or_else(|| {
                    let set = |lines: &[super::Line]| lines.iter().any(|line| line.set.is_some());
                    let names = [(set(&table.rows), &of_row.name), (set(&table.columns), &of_column.name)];
                    let mut parts: Vec<String> = names.iter().filter(|(differ, _)| *differ).map(|(_, name)| (*name).clone()).collect();
                    if seed > 0 {
                        parts.push(format!("seed {}", config.frame.seed));
                    }
                    let label = if parts.is_empty() { table.name.clone() } else { parts.join(", ") };
                    all.push(Run { key, label, config, set: BTreeMap::new(), walks: BTreeMap::new(), needs_reference: false });
                    all.len() - 1
                });
                of_cell[row][column].push(at);
            }
        }
        let mut needed = vec![false; all.len()];
        for (row, column) in table.places() {
            let measure = table.measure(row, column);
            for seed in 0..measure.seeds as usize {
                let of = of_cell[row][column][seed];
                match &measure.what {
                    What::Ratio { .. } => continue,
                    What::Flicker { layer } => _ = all[of].walks.insert(layer.name(), *layer),
                    What::Error { against: Against::Reference, .. } => all[of].needs_reference = true,
                    What::Error { against: Against::Cell(place), .. } => {
                        let (row, column) = place.from(row, column);
                        needed[of_seed(&of_cell[row][column], seed)] = true;
                    }
                    What::Time { .. } | What::Count { .. } | What::Memory { .. } => {}
                }
                needed[of] = true;
            }
        }
        let mut runs = Vec::new();
        let places: Vec<usize> = needed
            .iter()
            .zip(all)
            .map(|(needed, run)| {
                if *needed {
                    runs.push(run);
                }
                runs.len().saturating_sub(1)
            })
            .collect();
        of_cell.iter_mut().flatten().flatten().for_each(|run| *run = places[*run]);
        tell_apart(&mut runs);
        // Cells of a line share what it says.
        let mut told = BTreeSet::new();
        warnings.retain(|warning: &String| told.insert(warning.clone()));
        Ok(Self { runs, of_cell, sweep: sweep.clone(), warnings })
    }

    /// The run of a cell's first seed. The cell must not be a ratio, unless another cell is measured against it.
    pub fn run(&self, row: usize, column: usize) -> &Run {
        self.seed(row, column, 0)
    }

    /// The run of a cell's seed, by its number from 0 on; of a cell without seeds, its only run.
    pub fn seed(&self, row: usize, column: usize, seed: usize) -> &Run {
        &self.runs[of_seed(&self.of_cell[row][column], seed)]
    }
}

fn of_seed(runs: &[usize], seed: usize) -> usize {
    if runs.len() == 1 { runs[0] } else { runs[seed] }
}

/// All names in the frames of a table's runs.
#[derive(Debug, Default)]
pub struct Names {
    pub passes: BTreeSet<String>,
    /// Resources of the frames, including the counts of passes.
    pub resources: BTreeSet<String>,
}

/// Counts that a record has beside those of passes.
const COUNTED: [&str; 4] = ["scene/triangles", "vpls/count", "light-caches/count", "device/memory-bytes"];

impl Names {
    /// Refuses measures of names that no frame of the table has.
    ///
    /// # Errors
    /// `BadInput` with file, line and the known names.
    pub fn check(&self, table: &Table) -> Result<()> {
        let stages =
            |names: &BTreeSet<String>| names.iter().filter_map(|name| name.split('/').next()).map(str::to_owned).collect::<BTreeSet<_>>();
        for (row, column) in table.places() {
            let measure = table.measure(row, column);
            let (names, known): (Vec<&str>, BTreeSet<String>) = match &measure.what {
                What::Time { of } => {
                    (of.split('+').filter(|part| part.contains('/') && !part.ends_with('?')).collect(), self.passes.clone())
                }
                What::Count { of } => (vec![of], self.resources.iter().cloned().chain(COUNTED.map(str::to_owned)).collect()),
                What::Memory { of } if of.contains('/') => (vec![of], self.resources.clone()),
                What::Memory { of } if of != "frame" => (vec![of], stages(&self.resources)),
                _ => continue,
            };
            if let Some(of) = names.into_iter().find(|of| !known.iter().any(|name| name == of)) {
                let names: Vec<&str> = known.iter().map(String::as_str).collect();
                let hint = nearest(of, &names)
                    .map_or_else(|| format!("there are {}", names.join(", ")), |near| format!("did you mean \"{near}\"?"));
                return Err(error(&measure.origin, "measure", format_args!("no frame of this table has {}; {hint}", quoted(of))));
            }
        }
        Ok(())
    }
}

impl Sweep {
    fn apply(&self, mut config: Config, walks: bool) -> Config {
        config.frame.size = config.frame.size.map(|side| ((f64::from(side) * self.scale).round() as u32).max(1));
        if self.quick {
            config.frame.count = config.frame.count.min(if walks { QUICK_WALK } else { QUICK });
            config.frame.warmup = config.frame.warmup.min(2);
        }
        config
    }
}

fn hash(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex()[..12].to_owned()
}

/// A config as text, independent of the folder of the scene's file.
fn portable(config: &Config) -> String {
    let mut config = config.clone();
    config.scene.file = config.scene.file.as_ref().and_then(|file| file.file_name()).map(Into::into);
    to_toml(&config)
}

/// Sets each run's `set`, the keys in which runs differ.
fn tell_apart(runs: &mut [Run]) {
    let all: Vec<BTreeMap<String, String>> = runs.iter().map(|run| flat(&run.config)).collect();
    let keys: BTreeSet<&String> = all.iter().flat_map(BTreeMap::keys).collect();
    let differs = |key: &&String| all.iter().any(|config| config.get(*key) != all[0].get(*key));
    let differing: Vec<&String> = keys.into_iter().filter(differs).collect();
    for (run, config) in runs.iter_mut().zip(&all) {
        run.set = differing.iter().filter_map(|key| Some(((*key).clone(), config.get(*key)?.clone()))).collect();
    }
}

/// Dotted keys and their values as TOML; lists are values.
fn flat(config: &Config) -> BTreeMap<String, String> {
    fn walk(path: &str, value: &toml::Value, into: &mut BTreeMap<String, String>) {
        match value {
            toml::Value::Table(table) => {
                for (key, value) in table {
                    walk(&if path.is_empty() { key.clone() } else { format!("{path}.{key}") }, value, into);
                }
            }
            value => _ = into.insert(path.to_owned(), value.to_string()),
        }
    }
    let mut into = BTreeMap::new();
    if let Ok(value) = toml::Value::try_from(config) {
        walk("", &value, &mut into);
    }
    into
}
