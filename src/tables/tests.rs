//! Tests of reading and planning tables, and of refused mistakes.

use super::cells;
use super::folders::{self, reference_folder, run_folder};
use super::plan::Sweep;
use super::{Plan, Table, What, print};
use crate::{presets, stages};
use anyhow::Result;
use serde_json::json;
use std::path::Path;

fn read(text: &str, path: &Path, scenes: Option<&Path>) -> Result<Table> {
    super::read::table(text, path, scenes, &stages::names())
}

const SMALL: &str = r#"
title = "Small"
source = "Somebody 2020, table 1"
base = "cornell"
set = { frame = { size = [64, 36], count = 2 } }
share_of = { column = "frame" }
relative_to = { row = "one" }
deviations = ["another box"]

[published]
hardware = "a fast GPU"
[published.figures]
"one" = [40.0, 50.0, 1.0]
"four" = [10.0, 40.0, "-"]

[[row]]
name = "one"
set = { gather = { interleave = 1 } }

[[row]]
name = "four"
set = { gather = { interleave = 4 } }

[[column]]
name = "gather"
measure = { time = "gather" }

[[column]]
name = "frame"
measure = { time = "frame" }
sum = true

[[column]]
name = "speed-up"
measure = { ratio = { of = { row = "one", column = "gather" }, over = { column = "gather" } } }

[[column]]
name = "error"
measure = { error = "relmse", layer = "irradiance", against = { row = "one" } }
own = true
"#;

fn small() -> Table {
    read(SMALL, Path::new("small.toml"), None).unwrap_or_else(|error| panic!("{error:#}"))
}

#[test]
fn every_table_that_comes_with_the_program_can_be_read_and_planned() {
    assert!(presets::tables().len() >= 2);
    for (name, text) in presets::tables() {
        let table = read(text, &Path::new(name).with_extension("toml"), None).unwrap_or_else(|error| panic!("{error:#}"));
        let plan = Plan::of(&table, &Sweep { scale: 0.25, quick: true, sets: Vec::new() }).unwrap_or_else(|error| panic!("{error:#}"));
        assert!(!plan.runs.is_empty(), "{name}");
        assert_eq!(plan.warnings, Vec::<String>::new(), "{name}");
        assert!(!presets::title(text).is_empty(), "{name}: says nothing of itself in manylight list");
        let times = table.places().any(|(row, column)| {
            let has_figure = table.published.as_ref().is_some_and(|published| published.figures[row][column].is_some());
            has_figure && matches!(table.measure(row, column).what, What::Time { .. })
        });
        assert!(
            !times || table.share_of.is_some() || table.relative_to.is_some(),
            "{name}: a paper's times mean something as shares alone"
        );
    }
}

#[test]
fn a_bar_has_neither_the_whole_nor_sums_nor_our_own_lines() {
    let parts = |name: &str| {
        let text = presets::tables().into_iter().find(|(known, _)| *known == name).unwrap().1;
        let table = read(text, &Path::new(name).with_extension("toml"), None).unwrap();
        let stacks = table.stacks(|_, _| [None; 2]).into_iter();
        stacks.map(|stack| (stack.name, stack.parts.into_iter().map(|part| part.name).collect::<Vec<_>>())).collect::<Vec<_>>()
    };
    let expected = ["PL 1", "PL 2", "PL 3", "PL > 3", "PS > 2", "PS 2", "PS 1", "PS 0"].map(str::to_owned).to_vec();
    assert_eq!(parts("linke-5.4"), [("pull-push".to_owned(), expected)]);
    let stages = ["G-buffer", "Misc", "Paraboloid", "Shade"].map(str::to_owned).to_vec();
    let clusters = [4, 8, 16, 32].map(|count| (format!("{count} clusters"), stages.clone()));
    assert_eq!(parts("ssvp-1"), clusters);
    assert_eq!(parts("barak-2"), [], "ratios make no whole");
}

#[test]
fn cells_of_the_same_config_share_a_run() {
    let plan = Plan::of(&small(), &Sweep::default()).unwrap();
    let runs: Vec<_> = plan.runs.iter().map(|run| (run.label.as_str(), run.set.clone())).collect();
    assert_eq!(runs.len(), 2, "{runs:?}");
    assert_eq!((runs[0].0, runs[1].0), ("one", "four"));
    assert_eq!(runs[1].1, [("gather.interleave".to_owned(), "4".to_owned())].into(), "only what differs is said");
    assert_eq!(plan.run(1, 0).key, plan.run(1, 3).key);
    assert_ne!(plan.run(0, 0).key, plan.run(1, 0).key);
}

#[test]
fn a_sweep_is_scaled_shortened_and_changed_as_a_whole() {
    let sweep = Sweep { scale: 0.5, quick: true, sets: vec!["vpls.count=64".to_owned(), "frame.count=9".to_owned()] };
    let plan = Plan::of(&small(), &sweep).unwrap();
    for run in &plan.runs {
        assert_eq!((run.config.frame.size, run.config.frame.count, run.config.vpls.count), ([32, 18], 3, 64));
    }
    let whole = Plan::of(&small(), &Sweep::default()).unwrap();
    assert!(plan.runs.iter().all(|run| whole.runs.iter().all(|other| other.key != run.key)), "other configs have other folders");
}

/// Writes a run as a render would, without pictures.
fn leave(folder: &Path, plan: &Plan, run: usize, gather: f64, kind: &str) {
    let own = run_folder(folder, &plan.runs[run]);
    std::fs::create_dir_all(&own).unwrap();
    let row = |name: &str, ms: f64| json!({ "name": name, "median": ms, "p5": 0.9 * ms, "p95": 1.1 * ms, "n": 2, "share": 1.0 });
    let record = json!({
        "version": "0.1.0", "shaders": "a key", "timing_mode": "isolated",
        "device": { "name": "a device", "kind": kind, "driver": "a driver", "driver_version": "1" },
        "config": { "scene": { "file": "/somewhere/hall.glb" } }, "counts": { "scene/triangles": 1_234_567 }, "warnings": ["it is dark"],
        "timings": { "stages": [row("gather", gather)], "passes": [row("gather/per-pixel", gather)], "total": row("", 2.0 * gather) },
    });
    std::fs::write(own.join("run.json"), record.to_string()).unwrap();
    let pixels = |value: f32| vec![value; 12];
    let layer = crate::output::ExrLayer::interleaved("irradiance", "RGB", 3, &pixels(run as f32), crate::output::exr::Precision::Float);
    crate::output::write_exr(&own.join("image.exr"), 2, 2, vec![layer], &[]).unwrap();
}

#[test]
fn cells_come_from_the_folders_of_runs_with_the_papers_and_both_as_shares_and_ratios_on_every_device() {
    let (table, folder) = (small(), tempfile::tempdir().unwrap());
    let plan = Plan::of(&table, &Sweep::default()).unwrap();
    let results = cells::results(&table, &plan, folder.path()).unwrap();
    assert!(print::text(&results).contains("8 of 8 cells have no figure (one, gather: its run is missing)"), "{}", print::text(&results));
    assert!(!results.complete && results.cells.iter().flatten().all(|cell| cell.value.is_none() && cell.why.is_some()));
    for kind in ["gpu", "cpu"] {
        leave(folder.path(), &plan, 0, 30.0, kind);
        leave(folder.path(), &plan, 1, 2.0, kind);
        let results = cells::results(&table, &plan, folder.path()).unwrap();
        assert!(results.complete);
        let value = |row: usize, column: usize| results.cells[row][column].value.unwrap();
        assert_eq!((value(0, 0), value(1, 0), value(1, 1), value(1, 2), value(0, 3)), (30.0, 2.0, 4.0, 15.0, 0.0));
        assert!((value(1, 3) - 1.0 / 0.01).abs() < 1e-6, "(1 - 0)^2 over 0 and relMSE's constant");
        let cell = &results.cells[1][0];
        assert_eq!((cell.share, cell.published_share), (Some(0.5), Some(0.25)));
        assert_eq!((cell.relative, cell.published_relative, cell.published), (Some(2.0 / 30.0), Some(0.25), Some(10.0)));
        assert_eq!(results.cells[1][2].share, None, "a ratio is no share of a time");
        let parts = |stack: &super::Stack| stack.parts.iter().map(|part| (part.name.clone(), part.share, part.published_share)).collect();
        let stacks: Vec<(&str, Vec<_>)> = results.stacks.iter().map(|stack| (stack.name.as_str(), parts(stack))).collect();
        let gather = |paper| vec![("gather".to_owned(), Some(0.5), Some(paper))];
        assert_eq!(stacks, [("one", gather(0.8)), ("four", gather(0.25))], "the sum and our own column are no parts");
        let text = print::text(&results);
        let under = |name: &str| text.lines().filter(|line| line.starts_with(name)).map(str::to_owned).collect::<Vec<_>>();
        for (name, figures) in [
            ("four", &["2 ms", "4 ms", "15x"][..]),
            ("  share of frame", &["50.0 %", "100.0 %"]),
            ("  over one", &["0.0667x", "0.0667x"]),
            ("  paper  ", &["10 ms", "40 ms"]),
            ("  paper, share of frame", &["25.0 %", "100.0 %"]),
            ("  paper, over one", &["0.250x", "0.800x"]),
        ] {
            let lines = under(name);
            let last = lines.last().unwrap_or_else(|| panic!("{name}: {text}"));
            assert!(figures.iter().all(|figure| last.contains(figure)), "{name}: {text}");
        }
        assert_eq!(under("  over one").len(), 1, "the line of the whole itself is left out: {text}");
        assert!(text.contains("ours: hall.glb (1,234,567 triangles); 64x36; a device"), "{text}");
        assert!(text.contains("(a processor, no GPU)") == (kind == "cpu"), "{text}");
        assert!(text.contains("times: medians of 2 frames, each pass by itself, between barriers; nine frames of ten"), "{text}");
        assert!(text.contains("within ±10 % of theirs, ±10 % at worst"), "{text}");
        assert_eq!(text.matches("warning: it is dark").count(), 1, "both runs have it: {text}");
        assert!(text.contains("another box") && text.contains("different hardware"), "{text}");
        let markdown = print::markdown(&results);
        assert!(markdown.contains("| *paper, share of frame* | 25.0 % | 100.0 % |"), "{markdown}");
        results.write(folder.path()).unwrap();
        let csv = std::fs::read_to_string(folder.path().join("table.csv")).unwrap();
        assert_eq!(csv.lines().count(), 9);
        assert!(csv.contains("small,four,speed-up,ratio,x,15,,,,,,"), "{csv}");
        assert!(csv.contains("small,four,gather,time of gather,ms,2,1.8,2.2,,2,10,0.5,0.25,"), "{csv}");
    }
}

#[test]
fn a_mean_of_seeds_has_a_run_a_seed_their_spread_and_one_truth() {
    let text = SMALL.replacen("against = { row = \"one\" }", "against = { row = \"one\" }, seeds = 3", 1);
    let (table, folder) = (read(&text, Path::new("small.toml"), None).unwrap(), tempfile::tempdir().unwrap());
    let plan = Plan::of(&table, &Sweep::default()).unwrap();
    let labels: Vec<&str> = plan.runs.iter().map(|run| run.label.as_str()).collect();
    assert_eq!(labels, ["one", "one, seed 1", "one, seed 2", "four", "four, seed 1", "four, seed 2"]);
    let seeds: Vec<u32> = plan.runs.iter().map(|run| run.config.frame.seed).collect();
    assert_eq!(seeds, [0, 1, 2, 0, 1, 2]);
    let truths: std::collections::BTreeSet<String> = plan.runs.iter().map(|run| run.reference_key(&table)).collect();
    assert_eq!(truths.len(), 1);
    // Runs' pictures are as bright as their numbers, so each seed is off by 3 from the other row's.
    (0..5).for_each(|run| leave(folder.path(), &plan, run, 1.0, "gpu"));
    let results = cells::results(&table, &plan, folder.path()).unwrap();
    assert_eq!(results.cells[1][3].why.as_deref(), Some("seed 2: its run is missing"));
    leave(folder.path(), &plan, 5, 1.0, "gpu");
    let results = cells::results(&table, &plan, folder.path()).unwrap();
    let cell = &results.cells[1][3];
    let values = [0.0_f64, 1.0, 2.0].map(|r| 9.0 / (r * r + 0.01));
    let mean = values.iter().sum::<f64>() / 3.0;
    let spread = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 2.0).sqrt();
    let close = |ours: Option<f64>, exact: f64| (ours.unwrap() / exact - 1.0).abs() < 1e-6;
    assert!(close(cell.value, mean) && close(cell.spread, spread) && cell.n == Some(3), "{cell:?}");
    let text = print::text(&results);
    assert!(text.contains(" ±") && text.contains("mean and standard deviation of 3 seeds"), "{text}");
}

#[test]
fn seeds_share_the_picture_that_they_are_measured_against_if_it_has_none_of_its_own() {
    let text = SMALL.replacen("against = { row = \"one\" }", "against = { row = \"one\", column = \"truth\" }, seeds = 3", 1)
        + "\n[[column]]\nname = \"truth\"\nmeasure = { count = \"vpls/count\" }\nown = true\n";
    let (table, folder) = (read(&text, Path::new("small.toml"), None).unwrap(), tempfile::tempdir().unwrap());
    let plan = Plan::of(&table, &Sweep::default()).unwrap();
    assert!((0..3).all(|seed| plan.seed(0, 4, seed).config.frame.seed == 0), "the truth has several seeds");
    (0..plan.runs.len()).for_each(|run| leave(folder.path(), &plan, run, 1.0, "gpu"));
    let results = cells::results(&table, &plan, folder.path()).unwrap();
    // Runs' pictures are as bright as their numbers: the first row's are 0, 1 and 2, and the second row's 3, 4 and 5.
    let mean = [3.0_f64, 4.0, 5.0].map(|bright| bright.powi(2) / 0.01).iter().sum::<f64>() / 3.0;
    let found = results.cells[1][3].value.unwrap();
    assert!((found / mean - 1.0).abs() < 1e-3, "{found} instead of {mean}");
}

#[test]
fn runs_of_two_devices_do_not_go_into_one_table() {
    let (table, folder) = (small(), tempfile::tempdir().unwrap());
    let plan = Plan::of(&table, &Sweep::default()).unwrap();
    leave(folder.path(), &plan, 0, 30.0, "gpu");
    leave(folder.path(), &plan, 1, 2.0, "cpu");
    let error = cells::results(&table, &plan, folder.path()).unwrap_err().to_string();
    assert!(error.contains("different devices"), "{error}");
}

#[test]
fn a_run_is_current_while_version_and_shaders_are_the_same() {
    let (table, folder) = (small(), tempfile::tempdir().unwrap());
    let plan = Plan::of(&table, &Sweep::default()).unwrap();
    let [first, second] = [&plan.runs[0], &plan.runs[1]];
    let is_current = |run, shaders| folders::is_current(folder.path(), run, shaders);
    assert!(!is_current(first, "a key"), "nothing has run");
    leave(folder.path(), &plan, 0, 30.0, "gpu");
    leave(folder.path(), &plan, 1, 2.0, "gpu");
    assert!(is_current(first, "a key") && !is_current(first, "another key"));
    let record = run_folder(folder.path(), second).join("run.json");
    let change = |from: &str, to: &str| {
        let text = std::fs::read_to_string(&record).unwrap();
        assert!(text.contains(from), "{text}");
        std::fs::write(&record, text.replace(from, to)).unwrap();
    };
    change("0.1.0", "0.0.1");
    assert!(!is_current(second, "a key"), "of another version");
    change("0.0.1", "0.1.0");
    cells::results(&table, &plan, folder.path()).unwrap();
    change("a key", "another key");
    let error = cells::results(&table, &plan, folder.path()).unwrap_err().to_string();
    assert!(error.contains("different devices, timing modes, versions or shaders"), "{error}");
}

#[test]
fn a_truth_is_shared_by_runs_that_differ_in_the_pipeline_alone() {
    let (_, text) = presets::tables().into_iter().find(|(name, _)| *name == "vpl-count").unwrap();
    let table = read(text, Path::new("vpl-count.toml"), None).unwrap();
    let plan = Plan::of(&table, &Sweep::default()).unwrap();
    assert!(plan.runs.iter().all(|run| run.needs_reference));
    let keys: std::collections::BTreeSet<String> = plan.runs.iter().map(|run| run.reference_key(&table)).collect();
    assert_eq!(keys.len(), 1);
    let other = Plan::of(&table, &Sweep { sets: vec!["scene.seed=1".to_owned()], ..Sweep::default() }).unwrap();
    assert!(!keys.contains(&other.runs[0].reference_key(&table)));
    assert!(reference_folder(Path::new("a"), "b").ends_with("references/b"));
}

#[test]
fn mistakes_are_refused_by_file_line_and_key() {
    let cases = [
        ("title = \"Small\"", "", "small.toml: title: is missing"),
        (
            "base = \"cornell\"",
            "base = \"cornel\"",
            "small.toml:4: base: \"cornel\" is neither a preset nor a file; did you mean \"cornell\"?",
        ),
        ("relative_to", "relativ_to", "small.toml:7: relativ_to: unknown key; did you mean \"relative_to\"?"),
        (
            "relative_to = { row = \"one\" }",
            "relative_to = { row = \"on\" }",
            "small.toml:7: relative_to.row: there is no row \"on\"; did you mean \"one\"?",
        ),
        ("\"four\" = [10.0, 40.0, \"-\"]", "\"four\" = [10.0]", "small.toml:14: published.figures.four: has 1 figures for 3 columns"),
        ("\"four\" = [10.0, 40.0, \"-\"]", "", "published.figures.four: is missing"),
        (
            "\"four\" = [10.0, 40.0, \"-\"]",
            "\"five\" = [10.0, 40.0, \"-\"]",
            "small.toml:14: published.figures.five: unknown key; known here are one, four",
        ),
        ("name = \"four\"", "name = \"one\"", "row.1.name: \"one\" is there twice"),
        (
            "time = \"gather\"",
            "tim = \"gather\"",
            "column.0.measure: expects one of time, ratio, error, flicker, count, memory; did you mean \"time\"?",
        ),
        ("time = \"gather\"", "time = \"gathr\"", "column.0.measure: there is no stage \"gathr\"; did you mean \"gather\"?"),
        (
            "error = \"relmse\"",
            "error = \"relms\"",
            "column.3.measure.error: expects one of rmse, mae, relmse, energy, worst, flip, found \"relms\"; did you mean \"relmse\"?",
        ),
        ("against = { row = \"one\" }", "against = \"truth\"", "column.3.measure.against: expects \"reference\" or a cell"),
        ("over = { column = \"gather\" }", "over = { column = \"speed-up\" }", "comes back to itself"),
        (
            "share_of = { column = \"frame\" }",
            "share_of = { column = \"fram\" }",
            "share_of.column: there is no column \"fram\"; did you mean",
        ),
        ("sum = true", "sum = 1", "column.1.sum: expects true or false"),
        ("measure = { time = \"gather\" }", "", "column.0: its cells measure nothing"),
        ("measure = { time = \"gather\" }", "measure = { time = \"gather\", count = \"a\" }", "measures time and count at once"),
        ("measure = { time = \"gather\" }", "measure = { flicker = \"irradianc\" }", "did you mean irradiance?"),
        ("measure = { time = \"gather\" }", "measure = { time = \"gather\", seeds = 4 }", "column.0.measure.seeds: unknown key"),
        (
            "against = { row = \"one\" } }",
            "against = { row = \"one\" }, seeds = 1 }",
            "column.3.measure.seeds: expects a whole number from 2 to 1024, found the whole number 1",
        ),
    ];
    for (from, to, expected) in cases {
        assert!(SMALL.contains(from), "{from}");
        let error = format!(
            "{:#}",
            read(&SMALL.replacen(from, to, 1), Path::new("small.toml"), None).err().unwrap_or_else(|| panic!("{to} was taken"))
        );
        assert!(error.contains(expected), "{to}: {error}");
    }
    // A cell's settings are checked with its base, before anything is rendered.
    let cells = [
        (
            "gather = { interleave = 4 }",
            "gather = { interleaf = 4 }",
            "small.toml:22: gather.interleaf: unknown key; did you mean \"interleave\"?",
        ),
        ("gather = { interleave = 4 }", "gather = { interleave = 3 }", "small.toml:22: gather.interleave: 3 is out of range"),
        ("gather = { interleave = 4 }", "scene = { file = \"none.glb\" }", "none.glb does not exist"),
    ];
    for (from, to, expected) in cells {
        let table = read(&SMALL.replacen(from, to, 1), Path::new("small.toml"), None).unwrap();
        let error = format!("{:#}", Plan::of(&table, &Sweep::default()).err().unwrap_or_else(|| panic!("{to} was taken")));
        assert!(error.contains(expected), "{to}: {error}");
    }
    assert!(matches!(small().measure(0, 0).what, What::Time { .. }));
}

#[test]
fn a_view_takes_its_stand_ins_place_where_its_scene_is() {
    let text = SMALL.replacen("own = true", "own = true\ninstead_of = \"sibenik\"", 1);
    let of = |scenes| read(&text, Path::new("small.toml"), scenes).unwrap_or_else(|error| panic!("{error:#}"));
    let scenes = |table: &Table| {
        let runs = Plan::of(table, &Sweep::default()).unwrap_or_else(|error| panic!("{error:#}")).runs;
        runs.into_iter().map(|run| run.config.scene.file).collect::<Vec<_>>()
    };
    let folder = tempfile::tempdir().unwrap();
    for (table, says) in [(of(None), "--scenes"), (of(Some(folder.path())), "sibenik.glb is not there")] {
        assert_eq!(table.columns[3].name, "error");
        assert!(
            table.deviations[1].starts_with("error is rendered in place of Sibenik") && table.deviations[1].contains(says),
            "{:?}",
            table.deviations
        );
        assert_eq!(scenes(&table), [None, None]);
    }
    let file = folder.path().join("sibenik.glb");
    std::fs::write(&file, "").unwrap();
    let table = of(Some(folder.path()));
    let runs = scenes(&table);
    assert_eq!((table.columns[3].name.as_str(), table.deviations.len()), ("Sibenik", 1));
    assert_eq!(runs, [None, Some(file.clone()), None, Some(file)]);
    // Of several views the first whose scene is there.
    let several = |list: &str| {
        let text = text.replace("\"sibenik\"", list);
        read(&text, Path::new("small.toml"), Some(folder.path()))
            .map(|table| table.columns[3].name.clone())
            .map_err(|error| format!("{error:#}"))
    };
    assert_eq!(several("[\"conference\", \"sibenik\", \"museum-hall\"]").unwrap(), "Sibenik");
    assert_eq!(several("[\"conference\", \"museum-hall\"]").unwrap(), "error");
    assert!(several("[]").unwrap_err().contains("column.3.instead_of: is empty"));
    let wrong = text.replace("\"sibenik\"", "\"sibenic\"");
    let error = format!("{:#}", read(&wrong, Path::new("small.toml"), None).err().unwrap());
    assert!(error.contains("did you mean \"sibenik\"?"), "{error}");
}
