//! Tests of `manylight flicker` and sequences of frames from the outside: files, shards, resuming, and one sentence for every
//! error.

use crate::place::{Place, text};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

const WALK: &str = "[scene]\nbuiltin = \"cornell\"\n[camera]\nkeyframes = [{ time = 0, position = [-0.5, 2.7, 10.8], target = [0, 2.7, 0] }, \
                    { time = 1, position = [1.5, 3.2, 8.5], target = [0.2, 2.6, 0] }]\n[frame]\nsize = [48, 36]\ncount = 5\nwarmup = 0\n\
                    [rsm]\nsize = [64, 64]\n[vpls]\ncount = 64\n";

fn on_a_walk() -> Place {
    Place::new(&[("walk.toml", WALK)])
}

fn frames(count: u32) -> Vec<String> {
    (0..count).flat_map(|frame| ["exr", "png"].map(|ending| format!("{frame:04}.{ending}"))).collect()
}

#[test]
fn a_walk_leaves_a_line_a_pair_its_figures_and_its_maps() {
    let place = on_a_walk();
    let stdout = place.succeeds("flicker walk.toml -o out --heatmap");
    let starts: Vec<&str> = stdout.lines().map(|line| line.split("  ").next().unwrap()).collect();
    let csv_path = Path::new("out").join("flicker.csv").display().to_string();
    assert_eq!(starts, ["0000-0001 RGB", "0001-0002 RGB", "0002-0003 RGB", "0003-0004 RGB", "all RGB", &csv_path]);
    assert_eq!(place.names("out"), ["flicker.csv", "flicker.json", "heatmaps"]);
    assert_eq!(place.names("out/heatmaps"), ["0000-0001.png", "0001-0002.png", "0002-0003.png", "0003-0004.png"]);
    let map = image::open(place.path("out/heatmaps/0000-0001.png")).unwrap();
    assert_eq!((map.width(), map.height()), (48, 36));

    let json = place.json("out/flicker.json");
    assert_eq!((&json["layer"], &json["frames"], &json["device"]["kind"]), (&"RGB".into(), &5.into(), &"cpu".into()));
    let steps = json["steps"].as_array().unwrap();
    let figure = |step: &Value, key: &str| step[key].as_f64().unwrap();
    let pooled = steps.iter().map(|step| figure(step, "flicker").powi(2) * figure(step, "matched")).sum::<f64>()
        / steps.iter().map(|step| figure(step, "matched")).sum::<f64>();
    assert!(figure(&json["flicker"], "flicker") > 0.0);
    assert!((figure(&json["flicker"], "flicker") / pooled.sqrt() - 1.0).abs() < 1e-12, "{json}");
    assert!(json["reference"].is_null() && json["excess"].is_null());

    let mut csv = csv::Reader::from_path(place.path("out/flicker.csv")).unwrap();
    let rows: Vec<csv::StringRecord> = csv.records().map(|row| row.unwrap()).collect();
    assert_eq!((rows.len(), &rows[0][2], &rows[4][0]), (5, "", "4"));
    for (row, step) in rows[1..].iter().zip(steps) {
        assert_eq!(row[2].parse::<f64>().unwrap(), figure(step, "flicker"));
    }

    // JSON on stdout equals the file, quiet output is the path's line, and both repeat.
    assert_eq!(place.succeeds("flicker walk.toml -o again --json"), text(&fs::read(place.path("out/flicker.json")).unwrap()));
    assert_eq!(place.succeeds("flicker walk.toml -o again -q"), format!("{}\nagain{}\n", stdout.lines().nth(4).unwrap(), &csv_path[3..]));
    assert_eq!(place.files("out"), place.files("again"));
    let direct = place.succeeds("flicker walk.toml -o direct -q --layer direct --frames 2");
    assert!(direct.starts_with("all direct  flicker "), "{direct}");
}

#[test]
fn a_sequence_in_parts_is_the_whole_one_and_can_be_compared_and_walked_against() {
    let place = on_a_walk();
    place.succeeds("render walk.toml -o whole --sequence -q");
    place.succeeds("render walk.toml -o plain -q");
    let whole = place.files("whole/frames");
    assert_eq!(whole.keys().cloned().collect::<Vec<_>>(), frames(5));
    assert_eq!(place.names("whole"), ["frames", "image.exr", "image.png", "run.json", "timings.csv"]);
    for (file, bytes) in place.files("plain").into_iter().filter(|(file, _)| file.starts_with("image")) {
        assert!(bytes == place.files("whole")[&file], "{file} is not what a run without --sequence leaves");
    }
    assert!(whole["0004.png"] == place.files("whole")["image.png"] && whole["0000.png"] != whole["0004.png"]);

    // Two shards write to one folder, the third to its own.
    for (part, folder) in [(1, "parts"), (2, "parts"), (3, "other")] {
        place.succeeds(&format!("render walk.toml -o {folder} --sequence --shard {part}/3 -q"));
    }
    assert_eq!(place.names("other/frames"), ["0002.exr", "0002.png"]);
    let mut parts = place.files("parts/frames");
    parts.extend(place.files("other/frames"));
    assert!(parts == whole, "the parts are not the whole: {:?}", parts.keys());
    let names = ["frames", "image.exr", "image.png", "run.1-of-3.json", "run.2-of-3.json", "timings.1-of-3.csv", "timings.2-of-3.csv"];
    assert_eq!(place.names("parts"), names);
    assert_eq!(place.names("other"), ["frames", "run.3-of-3.json", "timings.3-of-3.csv"]);
    assert_eq!(place.json("parts/run.1-of-3.json")["frames"], 2);

    // PNGs beside EXRs do not count as frames.
    let compared = place.succeeds("compare whole/frames whole/frames --layer indirect --max-rmse 0");
    assert_eq!(compared.lines().count(), 6, "{compared}");

    // Against itself a path has no excess and no error.
    let stdout = place.succeeds("flicker walk.toml -o flicker --reference whole");
    assert!(stdout.lines().take(5).all(|line| line.ends_with("  excess 0  rmse 0")), "{stdout}");
    let other = place.succeeds("flicker walk.toml -o flicker --reference whole/frames --set compose.exposure=2 --set light=[] -q --json");
    assert_eq!(serde_json::from_str::<Value>(&other).unwrap()["excess"], 0.0, "exposure is none of its business");
    // Another layer of the same files is another reference.
    place.succeeds("flicker walk.toml -o flicker --reference whole --layer indirect --reference-layer RGB -q");
    let json = place.json("flicker/flicker.json");
    let rmse: Vec<f64> = json["rmse"].as_array().unwrap().iter().map(|rmse| rmse.as_f64().unwrap()).collect();
    assert!(rmse.len() == 5 && rmse.iter().all(|rmse| *rmse > 0.0), "{rmse:?}");
    let [flicker, reference] = ["flicker", "reference"].map(|whose| json[whose]["flicker"].as_f64().unwrap());
    assert!(flicker < reference && json["excess"].as_f64().unwrap() == flicker - reference, "{flicker}, {reference}");
}

#[test]
fn a_reference_of_every_frame_is_made_in_parts_and_goes_on_where_it_was() {
    let place = on_a_walk();
    let run = |more: &str| place.succeeds(&format!("reference walk.toml --spp 3 --bounces 1 --set frame.count=3 {more}"));
    run("-o whole --sequence -q");
    assert_eq!(place.names("whole"), ["frames", "image.exr", "image.png", "run.json", "sums", "timings.csv"]);
    let (whole, sums) = (place.files("whole/frames"), place.files("whole/sums"));
    assert_eq!(whole.keys().cloned().collect::<Vec<_>>(), frames(3));
    assert_eq!(sums.keys().collect::<Vec<_>>(), ["0000.exr", "0001.exr", "0002.exr"]);
    run("-o single -q --frame 1");
    assert!(whole["0001.exr"] == place.files("single")["image.exr"], "a frame of a sequence is that frame");
    assert!(sums["0001.exr"] == place.files("single")["sums.exr"]);

    run("-o parts --sequence --shard 1/2 -q");
    assert_eq!(place.names("parts/frames"), [&frames(3)[..2], &frames(3)[4..]].concat());
    // Resuming traces the missing frame and leaves the others alone.
    let stdout = run("-o parts --sequence --resume");
    let how: Vec<bool> = stdout.lines().take(3).map(|line| line.ends_with("done before")).collect();
    assert_eq!(how, [true, false, true], "{stdout}");
    assert!(place.files("parts/frames") == whole && place.files("parts/sums") == sums);
    assert!(place.files("parts")["image.exr"] == whole["0002.exr"]);
    assert_eq!(place.json("parts/run.json")["checks"]["frames"]["0001"]["samples"], 3);

    // A frame of fewer paths, a lost picture, and a picture of another number of paths: all end as in the whole.
    place.succeeds("reference walk.toml --spp 1 --bounces 1 --set frame.count=3 -o short --sequence -q");
    fs::copy(place.path("whole/sums/0001.exr"), place.path("short/sums/0001.exr")).unwrap();
    for folder in ["frames", "sums"] {
        fs::copy(place.path(&format!("whole/{folder}/0002.exr")), place.path(&format!("short/{folder}/0002.exr"))).unwrap();
    }
    fs::remove_file(place.path("short/frames/0002.png")).unwrap();
    run("-o short --sequence --resume -q");
    assert!(place.files("short/frames") == whole && place.files("short/sums") == sums);
    let samples = |line: &str| {
        let stdout = place.succeeds(&format!("reference walk.toml --bounces 1 --set frame.count=3 -o more --sequence {line}"));
        stdout.lines().take(3).map(|line| line.split_whitespace().nth(1).unwrap().parse::<u32>().unwrap()).collect::<Vec<_>>()
    };
    // Each frame ends by its own error; an easy goal is met at the first check.
    assert_eq!(samples("--spp 40 --target-error 1e6"), [16; 3]);
    assert_eq!(samples("--spp 40 --target-error 1e6 --resume"), [16; 3]);

    place.refuses(
        "reference walk.toml --spp 3 --bounces 1 --set frame.count=3 -o short --sequence --resume --set frame.seed=8",
        &["short/sums/0000.exr", "another config, scene or seed"],
    );
    // The sequence's frames are a reference for the flicker of the same path.
    let walk = place.succeeds("flicker walk.toml -o flicker --frames 3 --reference whole --layer indirect -q");
    assert!(walk.contains("  reference ") && walk.contains("  excess ") && walk.contains("  rmse "), "{walk}");
}

#[test]
fn what_cannot_be_walked_is_said_in_one_sentence() {
    let place = on_a_walk();
    place.refuses("flicker walk.toml --frames 1", &["frame.count", "2 frames or more", "--frames"]);
    place.refuses("flicker walk.toml --layer irradiacne", &["--layer", "irradiacne", "did you mean irradiance?", "RGB, direct"]);
    place.refuses("flicker walk.toml --layer albedo", &["there are RGB, direct, indirect, irradiance"]);
    place.refuses("flicker walk.toml --reference nowhere", &["nowhere/0000.exr is missing", "manylight reference CONFIG --sequence"]);
    place.succeeds("render walk.toml -o short --sequence --frames 2 -q");
    place.refuses("flicker walk.toml --reference short", &["short/frames/0002.exr is missing"]);
    place.refuses("flicker walk.toml --frames 2 --size 32x32 -q --reference short", &["frame 0 and its reference", "32 x 32", "48 x 36"]);
    let no_layer = "flicker walk.toml --frames 2 -q --reference short --reference-layer indirect.bounce1";
    place.refuses(no_layer, &["short/frames/0000.exr: has no layer indirect.bounce1", "indirect"]);
    let away = "camera.keyframes=[{time=0,position=[0,2,9],target=[0,2,0]},{time=0.03,position=[0,2,9],target=[0,2,20]}]";
    place.refuses(&format!("flicker walk.toml --frames 2 -q --set {away}"), &["no frame shows anything of the one before it"]);
    for command in ["render", "reference"] {
        place.refuses(&format!("{command} walk.toml --sequence --shard 6/6"), &["--shard", "frame.count is 5", "fewer parts"]);
    }
    fs::write(place.path("file"), "in the way").unwrap();
    let blocked = place.run("flicker walk.toml -o file/out");
    assert_eq!(blocked.status.code(), Some(6), "{}", text(&blocked.stderr));
}

#[test]
fn a_walk_on_which_nothing_moves_is_told_so() {
    let place = on_a_walk();
    let output = place.run("flicker walk.toml --set camera.keyframes=[] --frames 2 --layer irradiance -o still");
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("nothing moves"), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("all irradiance  flicker 0 (0.00 % of the mean)  matched 100.0 %"), "{}", text(&output.stdout));
    assert_eq!(place.json("still/flicker.json")["warnings"].as_array().unwrap().len(), 1);
}

#[test]
fn a_preset_that_starts_from_another_walks_in_any_folder_by_its_name() {
    let place = on_a_walk();
    let line = "flicker atrium-walk --frames 2 --size 64x36 --set scene.triangles=10000 --set rsm.size=[64,64] --set vpls.count=64";
    let stdout = place.succeeds(&format!("{line} -o out"));
    assert!(stdout.contains("0000-0001 RGB  flicker 0."), "{stdout}");
    let json = place.json("out/flicker.json");
    assert_eq!((&json["preset"], &json["config"]["compose"]["exposure"]), (&"atrium-walk".into(), &json!(1.3f32)), "the base's exposure");
    // A file of the base's name in the current folder is another.
    fs::write(place.path("first-light.toml"), "[compose]\nexposure = 5.0\n").unwrap();
    place.succeeds(&format!("{line} -o out -q"));
    assert_eq!(place.json("out/flicker.json")["config"]["compose"]["exposure"], json!(1.3f32));
}
