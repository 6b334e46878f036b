//! Tables from the command line: repeated, sharded, resumed, refused.

use crate::place::{Place, text};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const TABLE: &str = r#"
title = "Small"
base = "cornell"
set = { frame = { size = [48, 32], count = 2, warmup = 1 }, vpls = { count = 64 }, filter = { kind = "none" } }

[reference]
error = 0.5
samples = 16

[[row]]
name = "1x1"
set = { gather = { interleave = 1 } }

[[row]]
name = "4x4"
set = { gather = { interleave = 4 } }

[[column]]
name = "gather"
measure = { time = "gather" }

[[column]]
name = "speed-up"
measure = { ratio = { of = { row = "1x1", column = "gather" }, over = { column = "gather" } } }

[[column]]
name = "against 1x1"
measure = { error = "rmse", layer = "indirect", against = { row = "1x1" } }

[[column]]
name = "against the truth"
measure = { error = "energy", layer = "indirect" }

[[column]]
name = "flicker"
measure = { flicker = "irradiance" }

[[column]]
name = "lit"
measure = { count = "vpls/lit" }

[[column]]
name = "memory"
measure = { memory = "gather" }

[[column]]
name = "filter"
measure = { time = "filter" }
"#;

/// A folder with the small table.
struct Tables(Place);

impl Tables {
    fn new() -> Self {
        Self(Place::new(&[("small.toml", TABLE)]))
    }

    /// The command with its own cache of references.
    fn command(&self, options: &[&str]) -> Command {
        let mut command = self.0.command("reproduce small.toml --quiet");
        command.args(options).env("XDG_CACHE_HOME", self.path("cache"));
        command
    }

    fn run(&self, options: &[&str]) -> Output {
        self.command(options).output().unwrap()
    }

    fn table(&self, options: &[&str], folder: &str) -> Value {
        let output = self.run(&[&["-o", folder], options].concat());
        assert!(output.status.success(), "{}", text(&output.stderr));
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.starts_with("Small\n") && text.contains("[cpu]"), "{text}");
        self.json(folder)
    }

    fn json(&self, folder: &str) -> Value {
        self.0.json(&format!("{folder}/small/table.json"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path(name)
    }
}

/// Cells of a table that are no times, as text with all digits.
fn without_times(table: &Value) -> Vec<String> {
    let cells = table["cells"].as_array().unwrap().iter().flat_map(|row| row.as_array().unwrap());
    let timed = |cell: &&Value| ["ms", "x"].contains(&cell["unit"].as_str().unwrap());
    cells.filter(|cell| !timed(cell)).map(Value::to_string).collect()
}

#[test]
fn a_table_measures_all_that_it_says_and_the_same_when_it_runs_again() {
    let place = Tables::new();
    let table = place.table(&[], "one");
    let value = |row: usize, column: usize| table["cells"][row][column]["value"].as_f64();
    assert_eq!(table["complete"], true);
    for row in 0..2 {
        assert!(value(row, 0).unwrap() > 0.0 && value(row, 1).unwrap() > 0.0);
        assert_eq!(table["cells"][row][0]["n"], 2);
        assert!((0.3..3.0).contains(&value(row, 3).unwrap()), "16 paths a pixel, but the mean of 1,536 pixels");
        assert_eq!(value(row, 4), Some(0.0), "nothing moves");
        assert!((1.0..=64.0).contains(&value(row, 5).unwrap()), "the spot's cone leaves the map's corners dark");
        assert!(value(row, 6).unwrap() > 0.0);
        assert_eq!((value(row, 7), table["cells"][row][7]["why"].as_str()), (None, Some("the frame has no filter")));
    }
    assert_eq!(value(0, 1), Some(1.0));
    assert_eq!(value(0, 2), Some(0.0));
    assert!(value(1, 2).unwrap() > 0.0);
    for name in ["table.md", "table.csv"] {
        assert!(place.path("one/small").join(name).is_file(), "{name}");
    }
    let run = table["cells"][0][0]["run"].as_str().unwrap();
    for name in ["image.png", "image.exr", "timings.csv", "run.json"] {
        assert!(place.path("one/small/runs").join(run).join(name).is_file(), "{name}");
    }
    assert_eq!(without_times(&place.table(&[], "two")), without_times(&table));
}

#[test]
fn the_parts_of_a_sweep_joined_are_the_whole() {
    let place = Tables::new();
    let whole = place.table(&[], "whole");
    for part in ["1/2", "2/2"] {
        let folder = format!("part-{}", &part[..1]);
        let table = place.table(&["--shard", part], &folder);
        assert_eq!(table["complete"], false);
    }
    let joined = place.table(&["--merge", "part-1", "part-2"], "joined");
    assert_eq!(joined["complete"], true);
    assert_eq!(without_times(&joined), without_times(&whole));
    // One part alone cannot be merged to the whole.
    let output = place.run(&["-o", "half", "--merge", "part-1"]);
    assert_eq!(output.status.code(), Some(2));
    let error = text(&output.stderr);
    assert!(error.contains("none of the 1 folders has small/runs/"), "{error}");
}

#[test]
fn a_sweep_goes_on_where_it_was_left() {
    let place = Tables::new();
    let first = place.table(&[], "out");
    let changed = |path: &Path| path.join("run.json").metadata().unwrap().modified().unwrap();
    let run = |row: usize| place.path("out/small/runs").join(first["cells"][row][0]["run"].as_str().unwrap());
    let before = changed(&run(0));
    std::fs::remove_file(run(1).join("run.json")).unwrap();
    let again = place.table(&["--resume"], "out");
    assert_eq!(changed(&run(0)), before, "what was done was done again");
    assert_eq!(again["complete"], true);
    assert_eq!(without_times(&again), without_times(&first));
    place.table(&[], "out");
    assert_ne!(changed(&run(0)), before, "without --resume all is done again");
}

#[test]
fn a_sweep_does_not_go_on_from_runs_of_other_shaders() {
    let place = Tables::new();
    let first = place.table(&[], "out");
    place.0.copy_shaders("glsl");
    let shader = place.path("glsl/compose/sum.comp");
    let source = std::fs::read_to_string(&shader).unwrap();
    let runs = || [0, 1].map(|row| place.0.json(&format!("out/small/runs/{}/run.json", first["cells"][row][0]["run"].as_str().unwrap())));
    let resume = || {
        let output = place.command(&["-o", "out", "--resume"]).env("MANYLIGHT_GLSL", place.path("glsl")).output().unwrap();
        assert!(output.status.success(), "{}", text(&output.stderr));
        runs()
    };
    let before = runs();
    assert_eq!(resume(), before, "the same shaders from a folder");
    std::fs::write(&shader, source + "// edited\n").unwrap();
    let after = resume();
    for (before, after) in before.iter().zip(&after) {
        assert_ne!(before["shaders"], after["shaders"]);
        assert_eq!(before["counts"]["vpls/lit"], after["counts"]["vpls/lit"]);
    }
    assert_eq!(after[0]["shaders"], after[1]["shaders"], "one run was left as it was");
    assert_eq!(without_times(&place.json("out")), without_times(&first));
}

#[test]
fn a_truth_is_traced_once_and_kept_for_the_next_table() {
    let place = Tables::new();
    place.table(&[], "one");
    let kept: Vec<_> = std::fs::read_dir(place.path("cache/manylight/references")).unwrap().collect();
    assert_eq!(kept.len(), 1, "both rows have the same truth");
    let record = kept[0].as_ref().unwrap().path().join("run.json");
    let traced = std::fs::read(&record).unwrap();
    let table = place.table(&["--set", "gather.interleave=2"], "two");
    let key = table["references"][0].as_str().unwrap();
    assert_eq!(std::fs::read(place.path("two/small/references").join(key).join("run.json")).unwrap(), traced, "it was traced again");
}

#[test]
fn a_table_that_is_wrong_is_refused_before_anything_is_rendered() {
    let place = Tables::new();
    for (from, to, expected) in [
        (
            "base = \"cornell\"",
            "base = \"cornel\"",
            "small.toml:3: base: \"cornel\" is neither a preset nor a file; did you mean \"cornell\"?",
        ),
        ("interleave = 4", "interleaf = 4", "small.toml:16: gather.interleaf: unknown key; did you mean \"interleave\"?"),
        ("time = \"filter\"", "time = \"filtr\"", "there is no stage \"filtr\"; did you mean \"filter\"?"),
    ] {
        std::fs::write(place.path("small.toml"), TABLE.replacen(from, to, 1)).unwrap();
        let output = place.run(&["-o", "out"]);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(expected), "{error}");
        assert!(!place.path("out").exists(), "{to}");
    }
    // Names known only to frames are refused before the first frame too.
    for (from, to, expected) in [
        (
            "time = \"gather\"",
            "time = \"gather/tild\"",
            "small.toml:20: measure: no frame of this table has \"gather/tild\"; did you mean \"gather/tiled\"?",
        ),
        ("count = \"vpls/lit\"", "count = \"vpls/lid\"", "did you mean \"vpls/lit\"?"),
        ("memory = \"gather\"", "memory = \"gathr\"", "did you mean \"gather\"?"),
    ] {
        std::fs::write(place.path("small.toml"), TABLE.replacen(from, to, 1)).unwrap();
        let output = place.run(&["-o", "out"]);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(expected), "{error}");
        assert!(!place.path("out/small/runs").exists() && !place.path("out/small/references").exists(), "{to}");
    }
    let lost = place.run(&["--scenes", "nowhere"]);
    let error = text(&lost.stderr);
    assert!(lost.status.code() == Some(2) && error.contains("--scenes nowhere: there is no such folder"), "{error}");
    let unknown = place.0.manylight().args(["reproduce", "interleavin"]).output().unwrap();
    let error = text(&unknown.stderr);
    assert!(unknown.status.code() == Some(2) && error.contains("did you mean interleaving?"), "{error}");
}
