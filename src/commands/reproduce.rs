//! `manylight reproduce TABLE`: runs the cells of a table, and prints them beside the paper's figures.

use super::measure::{Frames, Pictures, check_validation, write_picture};
use super::progress::Progress;
use super::setup::{self, On};
use super::truth::Truth;
use crate::cli::{ReproduceArgs, Shard};
use crate::config::{Config, SceneConfig};
use crate::fail;
use crate::files::{prepare_folder, write_file};
use crate::graph::{Execution, Library};
use crate::presets;
use crate::reference::scene_digest;
use crate::renderer::{Renderer, needs};
use crate::stages;
use crate::tables::folders::{WALKS, begin, is_current, reference_folder, run_folder};
use crate::tables::{Names, Plan, Run, Table, cells, print, read, sheet};
use crate::walk::{flicker_of_walk, stands_still};
use crate::world::Needs;
use anyhow::{Context, Result};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Runs or merges every given table. All are read and planned before anything is rendered.
pub fn run(args: &ReproduceArgs) -> Result<()> {
    if let Some(folder) = args.scenes.as_ref().filter(|folder| !folder.is_dir()) {
        return Err(fail!(BadInput, "--scenes {}: there is no such folder", folder.display()));
    }
    let tables = args.tables.iter().map(|name| named(name)).collect::<Result<Vec<_>>>()?.concat();
    let mut planned: Vec<(Table, Plan, PathBuf)> = Vec::new();
    for (text, path) in tables {
        let table = read::table(&text, &path, args.scenes.as_deref(), &stages::names())?;
        let plan = Plan::of(&table, &args.sweep())?;
        let folder = args.output().join(&table.name);
        if let Some((other, ..)) = planned.iter().find(|(other, ..)| other.name == table.name) {
            return Err(fail!(BadInput, "{}: two tables are called {}; run them one by one", path.display(), other.name));
        }
        planned.push((table, plan, folder));
    }
    let progress = Progress::new(args.quiet);
    planned.iter().flat_map(|(_, plan, _)| &plan.warnings).for_each(|warning| progress.warn(warning));
    let shaders = Library::new()?.key_of_all().to_hex().to_string();
    let mut session = Session { args, progress: &progress, shaders, open: None };
    // Runs are numbered over all tables, so that shards are about equally long.
    let mut number = 0;
    for (table, plan, folder) in &planned {
        prepare_folder(folder)?;
        if args.merge.is_empty() {
            session.sweep(table, plan, folder, &mut number)?;
        } else {
            merge(&args.merge, table, plan, folder)?;
        }
        let results = cells::results(table, plan, folder)?;
        results.write(folder)?;
        let sheet = if table.sheet { sheet::write(table, plan, folder)? } else { None };
        progress.suspend(|| {
            println!("{}{}", print::text(&results), folder.join("table.md").display());
            sheet.iter().for_each(|sheet| println!("{}", sheet.display()));
            println!();
        });
    }
    progress.end();
    if let Some(open) = session.open {
        check_validation(&open.renderer)?;
    }
    Ok(())
}

/// Text and path of each table that the name means.
fn named(name: &str) -> Result<Vec<(String, PathBuf)>> {
    let own = presets::tables();
    let path = Path::new(name);
    if path.is_file() {
        return Ok(vec![(crate::config::read_text(path)?, path.to_owned())]);
    }
    let of_paper = |table: &str| table.strip_prefix(name).is_some_and(|rest| rest.starts_with('-'));
    let mut found: Vec<_> = own.iter().filter(|(table, _)| *table == name).collect();
    if found.is_empty() {
        found = own.iter().filter(|(table, _)| name == "all" || of_paper(table)).collect();
    }
    if found.is_empty() {
        let names: Vec<&str> = own.iter().map(|(name, _)| *name).collect();
        let near = crate::config::nearest(name, &names).map_or_else(String::new, |near| format!("; did you mean {near}?"));
        return Err(fail!(BadInput, "{name}: is neither a table nor a file{near} There are {}", names.join(", ")));
    }
    Ok(found.into_iter().map(|(name, text)| ((*text).to_owned(), PathBuf::from(format!("{name}.toml")))).collect())
}

/// A device with a scene, kept from run to run.
struct Open {
    scene: SceneConfig,
    /// Needs of all runs on it.
    may_need: Needs,
    renderer: Renderer,
    /// Digest of everything in the scene that its reference depends on.
    digest: String,
}

struct Session<'a> {
    args: &'a ReproduceArgs,
    progress: &'a Progress,
    /// Key of the shaders that make the runs.
    shaders: String,
    open: Option<Open>,
}

impl Session<'_> {
    fn sweep(&mut self, table: &Table, plan: &Plan, folder: &Path, number: &mut u32) -> Result<()> {
        let mut todo: Vec<&Run> = Vec::new();
        for run in &plan.runs {
            let mine = self.args.shard.is_none_or(|shard: Shard| shard.has(*number));
            *number += 1;
            if mine && !(self.args.resume && is_current(folder, run, &self.shaders) && self.has_truth(table, run, folder)) {
                todo.push(run);
            }
        }
        if let Some(first) = todo.first() {
            self.check_names(table, plan, first)?;
        }
        for (i, run) in todo.iter().enumerate() {
            self.progress.step(i as u64, todo.len() as u64, &format!("{}: {}", table.name, run.label));
            self.one(table, run, folder).with_context(|| format!("{}: {}", table.name, run.label))?;
        }
        Ok(())
    }

    /// Checks the table's names of passes, counts and resources, which only described frames know: all runs of the first scene
    /// are asked. Opens the device so that all of them can run on it.
    fn check_names(&mut self, table: &Table, plan: &Plan, first: &Run) -> Result<()> {
        let same: Vec<&Run> = plan.runs.iter().filter(|run| run.config.scene == first.config.scene).collect();
        let all = same.iter().map(|run| needs_of(run)).fold(Needs::default(), Needs::and);
        let open = self.opened(&first.config, all)?;
        let mut names = Names::default();
        for run in &same {
            open.renderer.check(&run.config).with_context(|| format!("{}: {}", table.name, run.label))?;
            let (passes, resources) = open.renderer.names(&run.config)?;
            names.passes.extend(passes.into_iter().map(str::to_owned));
            names.resources.extend(resources);
        }
        // Names that only another scene's runs may have are checked when these run.
        if same.len() == plan.runs.len() { names.check(table) } else { Ok(()) }
    }

    fn has_truth(&self, table: &Table, run: &Run, folder: &Path) -> bool {
        !run.needs_reference || reference_folder(folder, &run.reference_key(table)).join("run.json").is_file()
    }

    fn one(&mut self, table: &Table, run: &Run, folder: &Path) -> Result<()> {
        let config = &run.config;
        let progress = self.progress;
        let open = self.opened(config, needs_of(run))?;
        open.renderer.check(config)?;
        if run.needs_reference {
            let key = run.reference_key(table);
            let truth = Truth { config: &run.truth(), digest: &open.digest, goal: table.reference };
            truth.bring(&mut open.renderer, &reference_folder(folder, &key), &table.name, progress)?;
        }
        let own = run_folder(folder, run);
        begin(folder, run)?;
        open.renderer.prepare(config, &[])?;
        let shown: Vec<(u32, u32)> = (0..config.frame.count).map(|frame| (frame, frame)).collect();
        let frames = Frames { warmup: config.frame.warmup, measured: &shown, pictures: Pictures::Last, dump: &[], check_nan: false };
        let execution = setup::execution(config, &open.renderer);
        let measured = frames.run(&mut open.renderer, config, &execution, None, &mut |_, _| Ok(()))?;
        if !run.walks.is_empty() {
            if stands_still(config) && !open.renderer.world().moves() {
                let message = "nothing moves, so that nothing flickers; camera.keyframes, the keyframes of a light or an animation of the scene make a walk";
                progress.warn(&format!("{}: {}: {message}", table.name, run.label));
            }
            let mut walks = BTreeMap::new();
            for (name, layer) in &run.walks {
                let walk = flicker_of_walk(&mut open.renderer, config, *layer, None, &Execution::default(), &mut |_| {
                    progress.tick();
                    Ok(())
                })?;
                walks.insert(*name, walk.flicker.flicker);
            }
            prepare_folder(&own)?;
            write_file(&own.join(WALKS), &serde_json::to_vec_pretty(&walks)?)?;
        }
        check_validation(&open.renderer)?;
        prepare_folder(&own)?;
        let from = setup::provenance(Path::new(&table.name), config, &open.renderer);
        write_picture(&own.join("image.exr"), &own.join("image.png"), measured.picture(), config, &from)?;
        measured.write_times(&own.join("timings.csv"), &from)?;
        let warnings = [open.renderer.warnings(config), measured.last.warnings()].concat();
        // The record is written last: a run that has one is complete.
        measured.record(&open.renderer, config, &from, None, warnings)?.write(&own.join("run.json"))
    }

    /// The device with the config's scene. A device with another scene is freed first.
    fn opened(&mut self, config: &Config, needs: Needs) -> Result<&mut Open> {
        let fits = |open: &Open| open.scene == config.scene && open.may_need == open.may_need.and(needs);
        if !self.open.as_ref().is_some_and(fits) {
            self.open = None;
            let opened = setup::open(config, On { device: self.args.device.as_ref(), validate: self.args.validate })?;
            opened.warnings.iter().for_each(|warning| self.progress.warn(warning));
            let digest = scene_digest(&opened.scene);
            self.open = Some(Open { scene: config.scene.clone(), may_need: needs, renderer: opened.bring(needs)?, digest });
        }
        let Some(open) = &mut self.open else { unreachable!("it has just been opened") };
        open.renderer.ensure(needs)?;
        Ok(open)
    }
}

/// A run's needs, including those of its reference.
fn needs_of(run: &Run) -> Needs {
    needs(&run.config).and(Needs { rays: run.needs_reference })
}

/// Copies a table's runs and references from the folders of shards into one folder.
fn merge(parts: &[PathBuf], table: &Table, plan: &Plan, folder: &Path) -> Result<()> {
    let names = plan.runs.iter().map(|run| PathBuf::from("runs").join(&run.key));
    let truths = plan.runs.iter().filter(|run| run.needs_reference).map(|run| PathBuf::from("references").join(run.reference_key(table)));
    for name in names.chain(truths) {
        let done = |part: &PathBuf| part.join(&table.name).join(&name).join("run.json").is_file();
        let Some(part) = parts.iter().find(|part| done(part)) else {
            return Err(fail!(
                BadInput,
                "{}: none of the {} folders has {}; run the shard that it is missing from, with the same --scale, --quick and --set",
                table.name,
                parts.len(),
                Path::new(&table.name).join(&name).display()
            ));
        };
        let (from, to) = (part.join(&table.name).join(&name), folder.join(&name));
        if from != to {
            super::truth::copy_folder(&from, &to)?;
        }
    }
    Ok(())
}
