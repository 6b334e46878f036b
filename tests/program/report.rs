//! Tests of `manylight report` from the outside: one file that a browser opens without any other.

use crate::place::{Place, text};
use serde_json::{Value, json};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

const SMALL: &str =
    "[scene]\nbuiltin = \"cornell\"\n[frame]\nsize = [64, 36]\ncount = 3\nwarmup = 1\n[rsm]\nsize = [64, 64]\n[vpls]\ncount = 64\n";

fn in_a_box() -> Place {
    Place::new(&[("box.toml", SMALL)])
}

/// A folder with three renders, their reference, and a table of one of them.
fn with_runs() -> Place {
    let place = in_a_box();
    place.succeeds("render box.toml -q --device cpu -o coarse --set gather.interleave=4");
    place.succeeds("render box.toml -q --device cpu -o middle --set gather.interleave=2");
    place.succeeds("render box.toml -q --device cpu -o fine --set gather.interleave=1");
    place.succeeds("reference box.toml -q --device cpu -o truth --spp 8 --bounces 1");
    fs::create_dir_all(place.path("table/runs")).unwrap();
    fs::rename(place.path("fine"), place.path("table/runs/k1")).unwrap();
    let device = place.json("coarse/run.json")["device"].clone();
    place.write("table/table.json", table(&device).to_string());
    place
}

fn table(device: &Value) -> Value {
    json!({
        "kind": "table", "name": "interleaving", "title": "Interleaved <sampling>", "source": "a paper, table 1", "about": null,
        "version": "0.1.0", "device": device, "timing_mode": "isolated", "scale": 1.0, "quick": false, "complete": true,
        "published": { "hardware": "a GPU", "scene": "a box", "settings": "64 VPLs" },
        "deviations": ["another box"],
        "rows": ["1x1"], "columns": ["gather", "speed-up"],
        "cells": [[
            { "measure": "time gather", "unit": "ms", "value": 40.2, "p5": 39.0, "p95": 42.0, "n": 3, "published": 77.77,
              "relative": 0.5, "published_relative": 0.25, "run": "k1", "reference": null, "why": null },
            { "measure": "speed-up", "unit": "x", "value": null, "p5": null, "p95": null, "n": null, "published": 8.88,
              "relative": null, "published_relative": null, "run": null, "reference": null, "why": "one row is no sweep" },
        ]],
        "runs": { "k1": { "label": "1x1", "set": { "gather.interleave": "1" } } },
        "references": [],
    })
}

/// A browser with a headless mode; `$MANYLIGHT_BROWSER` has precedence.
fn browser() -> Option<PathBuf> {
    let chosen = std::env::var_os("MANYLIGHT_BROWSER").filter(|name| !name.is_empty()).map(PathBuf::from);
    let path = std::env::var_os("PATH").unwrap_or_default();
    let find = |name: &str| std::env::split_paths(&path).map(|folder| folder.join(name)).find(|file| file.is_file());
    chosen.or_else(|| ["chromium", "chromium-browser", "google-chrome"].into_iter().find_map(find))
}

/// Output of the browser, which has a minute and its own profile.
fn browse(browser: &Path, place: &Place, options: &[&str], page: &Path) -> Output {
    let profile = tempfile::tempdir().unwrap();
    let mut command = Command::new(browser);
    command.current_dir(place.root());
    command.args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"]);
    command.args(["--disable-component-update", "--disable-sync", "--hide-scrollbars"]);
    command.arg(format!("--user-data-dir={}", profile.path().display())).args(options).arg(format!("file://{}", page.display()));
    let stdout = tempfile::NamedTempFile::new_in(place.root()).unwrap();
    let stderr = tempfile::NamedTempFile::new_in(place.root()).unwrap();
    let mut child = command.stdout(stdout.reopen().unwrap()).stderr(stderr.reopen().unwrap()).stdin(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if start.elapsed() > Duration::from_secs(60) {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("the browser takes longer than a minute: {}", fs::read_to_string(stderr.path()).unwrap_or_default());
        }
        std::thread::sleep(Duration::from_millis(50));
    };
    Output { status, stdout: fs::read(stdout.path()).unwrap(), stderr: fs::read(stderr.path()).unwrap() }
}

#[test]
fn a_report_shows_runs_beside_their_reference_and_a_table() {
    let place = with_runs();
    assert_eq!(place.succeeds("report table coarse middle truth -o new/report.html"), "new/report.html\n");
    let html = fs::read_to_string(place.path("new/report.html")).unwrap();
    for part in [
        "Interleaved &lt;sampling&gt;",
        "8 samples a pixel, 1 bounce",
        "relMSE of RGB",
        "FLIP of RGB",
        "Time by stage",
        "gather.interleave",
        "interleave = 4",
        "one row is no sweep",
        "another box",
        "[cpu]",
    ] {
        assert!(html.contains(part), "{part:?} is not in the report");
    }
    // The table's run is matched with the reference given beside it.
    assert_eq!(html.matches("<div class=\"slider\">").count(), 3);
    assert_eq!(html.matches("class=\"picture heatmap\"").count(), 3);
    assert_eq!(html.matches("<image id=\"p").count(), 1, "the reference is there once");
    // The tests' device is a CPU, and has the paper's times beside its own as well.
    for part in ["paper 8.88", "paper 77", "0.250×"] {
        assert!(html.contains(part), "{part:?} is not in the report");
    }
    // The page has no path of this machine and no clock: a second one is equal.
    assert!(!html.contains(&*place.root().to_string_lossy()));
    place.succeeds("report table coarse middle truth -o again.html");
    assert!(html == fs::read_to_string(place.path("again.html")).unwrap(), "two reports of the same folders differ");
    // Another layer has other errors.
    place.succeeds("report coarse truth --layer indirect=indirect.bounce1 -o layer.html");
    assert!(fs::read_to_string(place.path("layer.html")).unwrap().contains("relMSE of indirect=indirect.bounce1"));
    place.succeeds("report coarse truth --layer Z -o depth.html");
    let depth = fs::read_to_string(place.path("depth.html")).unwrap();
    assert!(depth.contains("relMSE of Z") && !depth.contains("FLIP of") && depth.contains("its own largest"), "depths have no FLIP");
    place.fails("report coarse truth --layer nothing", 2, &["truth/image.exr: has no layer nothing"]);
    match browser() {
        Some(browser) => in_a_browser(&place, &browser),
        // Written directly, since the test harness hides the printed output of passing tests.
        None => writeln!(std::io::stderr(), "SKIPPED: a report in a browser: there is no Chromium on PATH").unwrap(),
    }
}

/// Part of [`a_report_shows_runs_beside_their_reference_and_a_table`], so that its runs are made once.
fn in_a_browser(place: &Place, browser: &Path) {
    let page = place.path("again.html");
    let dom = text(&browse(browser, place, &["--dump-dom"], &page).stdout);
    assert!(dom.contains("data-ready=\"yes\""), "the page's script has not run: {}", &dom[..dom.len().min(500)]);
    assert!(!dom.contains("data-error="), "something is wrong on the page: {}", &dom[..dom.len().min(500)]);
    for part in ["id=\"s1\"", "id=\"s2\"", "Error against time", "style=\"--at: 50%;\""] {
        assert!(dom.contains(part), "{part:?} is not on the page");
    }
    for scheme in ["0", "1"] {
        let picture = place.path(&format!("scheme{scheme}.png"));
        let screenshot = format!("--screenshot={}", picture.display());
        let settings = format!("--blink-settings=preferredColorScheme={scheme}");
        let output = browse(browser, place, &[&screenshot, &settings, "--window-size=1200,1600"], &page);
        assert!(picture.is_file(), "no screenshot: {}", text(&output.stderr));
        let shown = manylight::output::read_png(&picture).unwrap();
        let pixel = |i: usize| &shown.values[3 * i..3 * i + 3];
        let pixels = shown.values.len() / 3;
        let written = (0..pixels).filter(|i| pixel(*i) != pixel(0)).count();
        assert!(written > pixels / 20, "the page is blank: {written} of {pixels} pixels");
        assert_eq!(pixel(0)[0] > 0.5, scheme == "1", "light or dark as asked");
        // The box's red wall is visible: the picture was decoded.
        let red = (0..pixels).filter(|i| pixel(*i)[0] > 3.0 * pixel(*i)[1].max(0.02) && pixel(*i)[0] > 3.0 * pixel(*i)[2].max(0.02));
        assert!(red.count() > 500, "the pictures are not shown");
    }
}

#[test]
fn what_cannot_be_reported_is_said_in_one_sentence() {
    let place = in_a_box();
    fs::create_dir(place.path("empty")).unwrap();
    place.fails("report empty", 2, &["empty: has no run.json, table.json or flicker.json"]);
    place.fails("report gone", 2, &["gone: cannot be read"]);
    place.write("broken/run.json", "{\n\"version\": }");
    place.fails("report broken", 2, &["broken/run.json: is not what a report can read", "line 2"]);
    let device = json!({ "name": "d", "kind": "cpu", "driver": "e", "driver_version": "1" });
    place.write("one/table.json", table(&device).to_string());
    place.write("two/table.json", table(&device).to_string());
    place.fails("report one two", 2, &["two: is a second table of the name interleaving"]);
    // A table without its runs is still shown.
    place.succeeds("report one");
    assert!(fs::read_to_string(place.path("report.html")).unwrap().contains("Folders that are not there: k1."));
    place.write("file", "in the way");
    place.fails("report one -o file/report.html", 6, &["file"]);
    place.fails("report one -o empty", 6, &["empty"]);
}
