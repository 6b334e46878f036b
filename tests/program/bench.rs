//! Tests of `manylight bench` and `--trace` from the outside.

use crate::place::{BOX, Place, text};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;

const PASSES: [&str; 11] = [
    "gbuffer/draw",
    "rsm/draw",
    "rsm/flux",
    "vpls/regular",
    "gather/tiled",
    "filter/rows",
    "filter/columns",
    "direct/moments",
    "direct/moments-blur",
    "direct/shade",
    "compose/sum",
];

#[test]
fn a_bench_prints_stages_and_passes_and_ends_with_one_line_to_paste() {
    let place = Place::new(&[("box.toml", BOX)]);
    let stdout = place.succeeds("bench box.toml --runs 3 --set gather.interleave=2 -o out --verbose");
    for pass in PASSES {
        assert!(stdout.lines().any(|line| line.starts_with(&format!("  {pass} "))), "{pass} is not in {stdout}");
    }
    for column in ["median", "p5", "p95", "share", "vpls/lit", "  rsm/flux"] {
        assert!(stdout.contains(column), "{column} is not in {stdout}");
    }
    let line = stdout.lines().last().unwrap();
    let parts: Vec<&str> = line.split(" · ").collect();
    assert_eq!(parts[..3], [&format!("manylight {}", env!("CARGO_PKG_VERSION")), "box gather.interleave=2", "64x48"]);
    assert!(parts[3].ends_with(" [cpu]") && parts[4].contains("Mesa"), "{line}");
    assert_eq!(parts[5..7], ["isolated", "n=3"]);
    assert!(parts[7].starts_with("total ") && parts[7].ends_with(" ms"), "{line}");
    let stages: Vec<&str> = parts[8..].iter().map(|part| part.split_once(' ').unwrap().0).collect();
    assert_eq!(stages, ["gbuffer", "rsm", "vpls", "gather", "filter", "direct", "compose"]);
    assert_eq!(stdout.matches(" · n=3 · ").count(), 1, "one line");

    // The record and times are like a render's, without pictures.
    assert_eq!(place.names("out"), ["run.json", "timings.csv"]);
    let run = place.json("out/run.json");
    assert_eq!((run["frames"].as_u64(), run["warmup"].as_u64()), (Some(3), Some(2)), "a warm-up is at least 2 frames");
    assert_eq!(run["timings"]["total"]["n"], 3);
    assert!((1..=64).contains(&run["counts"]["vpls/lit"].as_u64().unwrap()));
    assert_eq!(run["memory"]["resources"]["rsm/flux"], 64 * 64 * 16);
    let resources = run["memory"]["resources"].as_object().unwrap();
    let stages: BTreeMap<&str, u64> = resources.iter().fold(BTreeMap::new(), |mut stages, (name, bytes)| {
        *stages.entry(name.split_once('/').unwrap().0).or_default() += bytes.as_u64().unwrap();
        stages
    });
    assert_eq!(run["memory"]["stages"], serde_json::json!(stages));
    let csv = fs::read_to_string(place.path("out/timings.csv")).unwrap();
    assert_eq!(csv.lines().count(), 1 + 3 * PASSES.len());
}

#[test]
fn a_bench_writes_nothing_unasked_and_can_say_less_or_speak_json() {
    let place = Place::new(&[("box.toml", BOX)]);
    let quiet = place.succeeds("bench box.toml --runs 1 --warmup 0 --quiet --timing serial");
    assert_eq!(quiet.lines().count(), 1, "{quiet}");
    assert!(quiet.starts_with("manylight ") && quiet.contains(" · serial · n=1 · "), "{quiet}");
    let json: Value = serde_json::from_str(&place.succeeds("bench box.toml --runs 2 --warmup 1 --json")).unwrap();
    assert_eq!((json["frames"].as_u64(), json["warmup"].as_u64(), json["width"].as_u64()), (Some(2), Some(1), Some(64)));
    assert_eq!(place.names("."), ["box.toml"]);
    let output = place.run("bench box.toml --trace box.toml/trace.json");
    assert_eq!(output.status.code(), Some(6), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("box.toml"), "{}", text(&output.stderr));
    assert_eq!(place.run("bench nothing.toml").status.code(), Some(2));
}

#[test]
fn a_verbose_render_lists_passes_counts_and_memory() {
    let place = Place::new(&[("box.toml", BOX)]);
    let stdout = place.succeeds("render box.toml -o out --verbose --frames 1");
    for part in ["  gather/tiled ", "vpls/lit ", "  compose/radiance ", "memory of a frame"] {
        assert!(stdout.contains(part), "{part:?} is not in {stdout}");
    }
    let run = place.json("out/run.json");
    assert!(run["counts"]["vpls/lit"].as_u64().unwrap() > 0);
    assert_eq!(run["memory"]["resources"]["compose/radiance"], 64 * 48 * 8);
}

/// A slice of a trace.
#[derive(Debug, Clone)]
struct Slice {
    name: String,
    thread: (u64, u64),
    begin: f64,
    end: f64,
}

/// Checks a trace's format. Returns its slices, the host's and the device's.
fn slices(trace: &Value) -> [Vec<Slice>; 2] {
    let mut processes = BTreeMap::new();
    let mut threads = Vec::new();
    let mut slices = Vec::new();
    for event in trace["traceEvents"].as_array().unwrap() {
        let (pid, tid) = (event["pid"].as_u64().unwrap(), event["tid"].as_u64().unwrap());
        let name = event["name"].as_str().unwrap();
        match event["ph"].as_str().unwrap() {
            "M" if name == "process_name" => {
                processes.insert(pid, event["args"]["name"].as_str().unwrap().to_owned());
            }
            "M" => threads.push((pid, tid)),
            "X" => {
                let (begin, duration) = (event["ts"].as_f64().unwrap(), event["dur"].as_f64().unwrap());
                assert!(begin >= 0.0 && duration >= 0.0, "{event}");
                slices.push(Slice { name: name.to_owned(), thread: (pid, tid), begin, end: begin + duration });
            }
            other => panic!("an event of kind {other:?}"),
        }
    }
    assert!(slices.iter().all(|slice| threads.contains(&slice.thread)), "every thread has a name");
    // Slices on a thread are nested or disjoint.
    let mut open: Vec<Slice> = Vec::new();
    for slice in &slices {
        open.retain(|around| around.thread == slice.thread && around.end > slice.begin + 1e-3);
        if let Some(around) = open.last() {
            assert!(slice.begin >= around.begin && slice.end <= around.end + 1e-3, "{slice:?} is half in {around:?}");
        }
        open.push(slice.clone());
    }
    ["CPU", "GPU"].map(|name| slices.iter().filter(|slice| processes[&slice.thread.0] == name).cloned().collect())
}

#[test]
fn a_trace_shows_the_hosts_work_nested_and_every_pass_of_every_frame_in_order() {
    let place = Place::new(&[("box.toml", BOX)]);
    for timing in ["isolated", "overlapped", "serial"] {
        place.succeeds(&format!("bench box.toml --runs 3 --warmup 1 --quiet --trace traces/{timing}.json --timing {timing}"));
        let trace = place.json(&format!("traces/{timing}.json"));
        assert_eq!((&trace["otherData"]["timing_mode"], &trace["otherData"]["preset"]), (&Value::from(timing), &Value::from("box")));
        let [host, device] = slices(&trace);
        let names: Vec<&str> = device.iter().map(|slice| slice.name.as_str()).collect();
        assert_eq!(names, PASSES.repeat(4), "{timing}: a warm-up frame and three more");
        assert!(device.windows(2).all(|two| two[0].end <= two[1].begin + 1e-3), "{timing}: passes follow each other");
        let of = |name: &str| host.iter().filter(|slice| slice.name == name).collect::<Vec<_>>();
        for name in ["loading the scene", "opening the device", "bringing the scene to the device", "preparing the shaders"] {
            assert_eq!(of(name).len(), 1, "{timing}: {name}");
        }
        for name in ["shader gather/tiled.comp", "pipeline of gather/tiled", "recording scene/vertices"] {
            assert!(!of(name).is_empty(), "{timing}: {name}");
        }
        let frames = ["warm-up frame 0", "frame 0", "frame 1", "frame 2"].map(|name| {
            let found = of(name);
            assert_eq!(found.len(), 1, "{timing}: {name}");
            found[0].clone()
        });
        // The device works while the host waits for it, within the frame's slice.
        let within = |slice: &Slice, around: &Slice| slice.begin >= around.begin && slice.end <= around.end;
        for (passes, frame) in device.chunks(PASSES.len()).zip(&frames) {
            assert!(passes.iter().all(|pass| within(pass, frame)), "{timing}: {passes:?} are not in {frame:?}");
            for part in ["describing", "preparing", "reading back"] {
                assert_eq!(of(part).iter().filter(|slice| within(slice, frame)).count(), 1, "{timing}: {part}");
            }
            for pass in passes {
                let waiting = host.iter().filter(|slice| slice.name.starts_with("submitting and waiting for ")).any(|w| within(pass, w));
                assert!(waiting || timing == "serial", "{timing}: nobody waits for {pass:?}");
            }
        }
    }
}

#[test]
fn renders_and_references_write_traces_too() {
    let place = Place::new(&[("box.toml", BOX)]);
    place.succeeds("render box.toml -o out --quiet --frames 1 --trace out/trace.json");
    let [host, device] = slices(&place.json("out/trace.json"));
    assert_eq!(device.len(), 2 * PASSES.len());
    assert!(host.iter().any(|slice| slice.name == "writing"));
    place.succeeds("reference box.toml -o reference --quiet --spp 2 --bounces 1 --trace reference.json");
    let [host, device] = slices(&place.json("reference.json"));
    assert!(device.iter().filter(|slice| slice.name == "reference/path").count() >= 2);
    for name in ["building the hierarchy", "sample 0", "sample 1"] {
        assert_eq!(host.iter().filter(|slice| slice.name == name).count(), 1, "{name}");
    }
    let run = place.json("reference/run.json");
    assert!(run["memory"]["resources"]["reference/sums"].as_u64().unwrap() > 0);
}
