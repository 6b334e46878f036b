//! Tests of `manylight reference` from the outside: files, stopping and resuming, and one sentence for every error.

use crate::place::{Place, text};
use manylight::output::read_exr;
use std::fs;
use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

const SMALL: &str = "[scene]\nbuiltin = \"cornell\"\n[frame]\nsize = [48, 32]\n";

fn in_a_box() -> Place {
    Place::new(&[("box.toml", SMALL)])
}

fn bytes(path: &Path) -> Vec<u8> {
    fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Sends Ctrl-C by the shell's own `kill`, since not every system has the program.
fn interrupt(child: &Child) {
    let kill = format!("kill -INT {}", child.id());
    assert!(Command::new("sh").args(["-c", &kill]).status().unwrap().success());
}

fn samples(place: &Place, folder: &str) -> u64 {
    place.json(&format!("{folder}/run.json"))["counts"]["reference/samples"].as_u64().unwrap()
}

#[test]
fn a_reference_leaves_its_layers_a_picture_and_its_record() {
    let place = in_a_box();
    let stdout = place.succeeds("reference box.toml -o out --spp 4 --bounces 2 --validate");
    assert!(stdout.contains("image.png") && stdout.contains("4 samples") && stdout.contains("million a second"), "{stdout}");
    assert_eq!(place.names("out"), ["image.exr", "image.png", "run.json", "sums.exr", "timings.csv"]);
    let exr = read_exr(&place.path("out/image.exr")).unwrap();
    assert_eq!((exr.width, exr.height), (48, 32));
    let layers = ["direct", "indirect", "irradiance", "albedo", "indirect.bounce1", "indirect.bounce2", "variance"];
    let mut expected: Vec<String> = layers.iter().flat_map(|layer| ["R", "G", "B"].map(|c| format!("{layer}.{c}"))).collect();
    expected.extend(["N", "P"].iter().flat_map(|layer| ["X", "Y", "Z"].map(|c| format!("{layer}.{c}"))));
    expected.extend(["R", "G", "B", "A", "Z"].map(str::to_owned));
    expected.sort();
    assert_eq!(exr.channels.keys().cloned().collect::<Vec<_>>(), expected);
    // The layers add up: the box emits nothing.
    let sum = |i: usize| exr.channels["direct.R"][i] + exr.channels["indirect.bounce1.R"][i] + exr.channels["indirect.bounce2.R"][i];
    assert!((0..48 * 32).all(|i| (sum(i) - exr.channels["R"][i]).abs() < 1e-4 * (1.0 + sum(i))));
    assert!(exr.channels["R"].iter().sum::<f32>() > 10.0);
    let run = place.json("out/run.json");
    assert_eq!((run["counts"]["reference/samples"].as_u64(), run["counts"]["reference/bounces"].as_u64()), (Some(4), Some(2)));
    assert!(run["counts"]["reference/rays"].as_u64().unwrap() > 4 * 48 * 32);
    assert!(run["checks"]["relative-standard-error"].as_f64().unwrap() > 0.0);
    assert_eq!(run["config"]["frame"]["size"], serde_json::json!([48, 32]));
    // A render's layers compare with it.
    place.succeeds("render box.toml -o render --frames 1 --quiet");
    let output = place
        .manylight()
        .args(["compare", "render", "out", "--layer", "direct", "--layer", "indirect=indirect.bounce1", "--layer", "P"])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(text(&output.stdout).lines().count(), 3);
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_a_resumed_run_the_same_as_a_whole_one() {
    let place = in_a_box();
    place.succeeds("reference box.toml -o whole --spp 6 --bounces 1");
    place.succeeds("reference box.toml -o again --spp 6 --bounces 1");
    place.succeeds("reference box.toml -o parts --spp 2 --bounces 1");
    place.succeeds("reference box.toml -o parts --spp 6 --bounces 1 --resume");
    place.succeeds("reference box.toml -o other --spp 6 --bounces 1 --set frame.seed=1");
    for file in ["image.exr", "image.png", "sums.exr"] {
        let whole = bytes(&place.path("whole").join(file));
        assert!(whole == bytes(&place.path("again").join(file)), "{file} differs between two runs");
        assert!(whole == bytes(&place.path("parts").join(file)), "{file} differs where the run was resumed");
        assert!(whole != bytes(&place.path("other").join(file)), "{file} is the same with another seed");
    }
}

#[test]
fn a_run_stops_in_time_at_an_error_and_at_ctrl_c() {
    let place = in_a_box();
    let start = Instant::now();
    place.succeeds("reference box.toml -o time --spp 1000000 --time 1");
    assert!(start.elapsed() < Duration::from_secs(30) && samples(&place, "time") < 1_000_000);
    place.succeeds("reference box.toml -o error --spp 1000000 --target-error 0.2 --bounces 1");
    let error = place.json("error/run.json")["checks"]["relative-standard-error"].as_f64().unwrap();
    assert!(error <= 0.2 && samples(&place, "error") >= 16, "{error}");
    let mut child = place.command("reference box.toml -o stopped --spp 1000000 --quiet").spawn().unwrap();
    std::thread::sleep(Duration::from_secs(3));
    interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(0));
    let done = samples(&place, "stopped");
    assert!((1..1_000_000).contains(&done));
    // A stopped run can be resumed.
    place.succeeds(&format!("reference box.toml -o stopped --spp {} --resume", done + 2));
    assert_eq!(samples(&place, "stopped"), done + 2);
}

#[test]
fn what_cannot_be_resumed_or_written_is_said_in_one_sentence() {
    let place = in_a_box();
    place.fails("reference box.toml -o none --resume", 2, &["--resume: none/sums.exr is not there"]);
    place.succeeds("reference box.toml -o out --spp 1 --bounces 1");
    let before = bytes(&place.path("out/sums.exr"));
    place.fails("reference box.toml -o out --resume --bounces 2", 2, &["has 1 bounces, not 2"]);
    place.fails("reference box.toml -o out --resume --bounces 1 --set frame.seed=4", 2, &["another config, scene or seed"]);
    place.fails("reference box.toml -o out --resume --bounces 1 --size 32x32", 2, &["another config, scene or seed"]);
    place.fails("reference box.toml -o out --resume --bounces 1 --min-distance", 2, &["another config, scene or seed"]);
    assert!(before == bytes(&place.path("out/sums.exr")), "a refused run changes nothing");
    place.write("out/sums.exr", &before[..before.len() / 2]);
    place.fails("reference box.toml -o out --resume --bounces 1", 2, &["out/sums.exr"]);
    fs::copy(place.path("out/image.exr"), place.path("out/sums.exr")).unwrap();
    place.fails("reference box.toml -o out --resume --bounces 1", 2, &["was not written by `manylight reference`"]);
    place.write("file", "in the way");
    place.fails("reference box.toml -o file/out --spp 1", 6, &["file/out"]);
    place.fails("reference nothing.toml", 2, &["nothing.toml"]);
    place.fails("reference box.toml --set scene.builtin=castle", 2, &["scene.builtin", "castle"]);
    let lost = place
        .command("reference box.toml -o lost --spp 1 --bounces 1")
        .env("MANYLIGHT_FAULT", "device-lost:reference/path")
        .output()
        .unwrap();
    assert_eq!(lost.status.code(), Some(4), "{}", text(&lost.stderr));
    let full =
        place.command("reference box.toml -o full --spp 1").env("MANYLIGHT_FAULT", "out-of-memory:scene/bvh-nodes").output().unwrap();
    assert_eq!(full.status.code(), Some(5), "{}", text(&full.stderr));
    for folder in ["lost", "full"] {
        assert!(place.names(folder).is_empty(), "{folder}: {:?}", place.names(folder));
    }
}

#[test]
fn an_output_folder_that_vanishes_ends_with_its_code() {
    let place = in_a_box();
    let mut child = place.command("reference box.toml -o gone --spp 1000000 --quiet").stderr(std::process::Stdio::piped()).spawn().unwrap();
    std::thread::sleep(Duration::from_secs(3));
    fs::remove_dir_all(place.path("gone")).unwrap();
    interrupt(&child);
    let code = child.wait().unwrap().code();
    let mut stderr = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut stderr).unwrap();
    assert_eq!(code, Some(6), "{stderr}");
    assert!(stderr.contains("gone/"), "{stderr}");
}

#[test]
fn visibility_and_shadows_by_rays_render_without_a_word_from_the_validation_layer() {
    let place = in_a_box();
    place.write(
        "rays.toml",
        format!("{SMALL}count = 1\n[vpls]\ncount = 256\n[visibility]\nmethod = \"ray-traced\"\n[direct]\nshadows = \"ray-traced\"\n"),
    );
    let stdout = place.succeeds("render rays.toml -o out --validate --check-nan");
    assert!(stdout.contains("visibility"), "{stdout}");
    place.fails(
        "render rays.toml -o out2 --set gather.interleave=1 --set vpls.count=200000 --set rsm.size=[512,512]",
        2,
        &["gather.interleave"],
    );
}
