//! Tests of `manylight compare` from the outside: figures, exit codes, heatmaps, and one sentence for every error.

use crate::place::{Place, ended, text};
use manylight::output::exr::Precision;
use manylight::output::{ExrLayer, write_exr, write_png};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

const WIDTH: u32 = 40;
const HEIGHT: u32 = 30;

/// A folder of images.
struct Images(Place);

impl Images {
    fn new() -> Self {
        Self(Place::new(&[]))
    }

    /// Path of a file, whose folders are made.
    fn path(&self, name: &str) -> PathBuf {
        let path = self.0.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        path
    }

    /// Writes an image with the layers of a run and two bounces; `change` modifies its colours.
    fn exr(&self, name: &str, change: impl Fn(usize, f32) -> f32) {
        self.exr_of(name, WIDTH, HEIGHT, change);
    }

    fn exr_of(&self, name: &str, width: u32, height: u32, change: impl Fn(usize, f32) -> f32) {
        let values = |scale: f32| -> Vec<f32> {
            let value = |i: usize| change(i / 3, scale * (1.0 + ((i / 3 % 7) + i % 3) as f32));
            (0..width as usize * height as usize * 3).map(value).collect()
        };
        let colors = |name: &str, scale: f32| ExrLayer::interleaved(name, "RGB", 3, &values(scale), Precision::Float);
        let mut layers = vec![colors("", 1.0), colors("direct", 0.75)];
        layers.extend([colors("indirect.bounce1", 0.1875), colors("indirect.bounce2", 0.0625), colors("indirect", 0.25)]);
        layers.push(ExrLayer::interleaved("", "Z", 3, &values(2.0), Precision::Float));
        layers.push(ExrLayer::interleaved("N", "XYZ", 3, &values(0.1), Precision::Float));
        write_exr(&self.path(name), width, height, layers, &[]).unwrap();
    }

    fn compare(&self, arguments: &[&str]) -> Output {
        self.0.manylight().arg("compare").args(arguments).output().unwrap()
    }

    #[track_caller]
    fn json(&self, arguments: &[&str]) -> Value {
        let output = self.compare(&[arguments, &["--json"]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    }
}

/// Checks the exit code and the one line on stderr, which must contain all of `says`. Returns stdout.
#[track_caller]
fn failed(output: &Output, code: i32, says: &[&str]) -> String {
    ended("compare", output, code, says)
}

#[track_caller]
fn assert_near(figure: &Value, expected: f64) {
    let figure = figure.as_f64().unwrap();
    assert!((figure - expected).abs() < 1e-5, "{figure} is not {expected}");
}

/// Red, green and blue of a pixel.
fn pixel(path: &Path, x: u32, y: u32) -> [u8; 3] {
    image::open(path).unwrap().into_rgb8().get_pixel(x, y).0
}

#[test]
fn the_same_image_passes_the_strictest_thresholds() {
    let place = Images::new();
    place.exr("a.exr", |_, value| value);
    place.exr("b.exr", |_, value| value);
    let strict = ["--max-rmse", "0", "--max-relmse", "0", "--max-flip", "0", "--max-worst", "0", "--max-energy-error", "0"];
    let output = place.compare(&[&["a.exr", "b.exr"], &strict[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert_eq!(text(&output.stdout), "a.exr RGB  rmse 0  mae 0  relmse 0  energy 1.0000  worst 0  flip 0\n");
}

#[test]
fn a_figure_over_its_threshold_ends_with_1_after_everything_is_said() {
    let place = Images::new();
    place.exr("test.exr", |_, value| value * 1.1);
    place.exr("reference.exr", |_, value| value);
    let figures = &place.json(&["test.exr", "reference.exr"])["frames"][0];
    let cases = [("rmse", "rmse"), ("relmse", "relmse"), ("flip", "flip"), ("worst", "worst"), ("energy-error", "energy")];
    for (measure, key) in cases {
        let figure = figures[key].as_f64().unwrap();
        let figure = if key == "energy" { figure - 1.0 } else { figure };
        assert!(figure > 1e-4, "{measure}: {figure}");
        let option = format!("--max-{measure}");
        let under = (figure * 0.99).to_string();
        let output = place.compare(&["test.exr", "reference.exr", "--heatmap", "map.png", &option, &under]);
        let says = [&format!("test.exr: layer RGB: {}", measure.replace('-', " ")), under.as_str(), "over its threshold"];
        let stdout = failed(&output, 1, &says);
        assert!(stdout.starts_with("test.exr RGB  rmse "), "{stdout}");
        fs::remove_file(place.path("map.png")).unwrap();
        let output = place.compare(&["test.exr", "reference.exr", &option, &(figure * 1.01).to_string()]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    }
    // JSON lists exceeded thresholds beside the figures.
    let output = place.compare(&["test.exr", "reference.exr", "--json", "--max-rmse", "0.01", "--max-worst", "0.01"]);
    let json: Value = serde_json::from_str(&failed(&output, 1, &["rmse", "; 1 more over theirs"])).unwrap();
    assert_eq!((&json["over"][0]["measure"], &json["over"][1]["measure"]), (&"rmse".into(), &"worst".into()));
    assert_eq!((&json["over"][0]["figure"], &json["over"][0]["threshold"]), (&figures["rmse"], &0.01.into()));
}

#[test]
fn json_says_what_was_compared_how_it_was_and_over_all_frames() {
    let place = Images::new();
    place.exr("test.exr", |_, value| value * 1.1);
    place.exr("reference.exr", |_, value| value);
    let json = place.json(&["test.exr", "reference.exr", "--layer", "RGB", "--layer", "Z", "--layer", "N"]);
    // An object's keys have no order.
    let keys = |value: &Value| {
        value.as_object().unwrap().keys().cloned().collect::<std::collections::BTreeSet<_>>().into_iter().collect::<Vec<_>>()
    };
    assert_eq!(keys(&json), ["frames", "over", "reference", "summary", "test"]);
    assert_eq!((&json["test"], &json["reference"]), (&"test.exr".into(), &"reference.exr".into()));
    let [colors, depth, normals] = [0, 1, 2].map(|i| &json["frames"][i]);
    for line in [colors, depth, normals] {
        assert_eq!(keys(line), ["energy", "exposures", "flip", "frame", "layer", "mae", "mean", "relmse", "rmse", "worst"]);
    }
    assert_near(&colors["energy"], 1.1);
    assert_near(&depth["energy"], 1.1);
    assert!(colors["flip"].as_f64().unwrap() > 0.0 && colors["exposures"]["count"].as_u64().unwrap() >= 2);
    assert_eq!((&depth["flip"], &depth["exposures"], &normals["energy"]), (&Value::Null, &Value::Null, &Value::Null));
    assert_eq!(json["summary"][1]["layer"], "Z");
    assert_eq!(json["summary"][0]["frame"], "all");
    // A repeated comparison gives the same bytes.
    assert_eq!(place.json(&["test.exr", "reference.exr", "--layer", "RGB", "--layer", "Z", "--layer", "N"]).to_string(), json.to_string());
}

#[test]
fn layers_are_summed_and_held_against_others() {
    let place = Images::new();
    place.exr("image.exr", |_, value| value);
    for layers in ["direct+indirect=RGB", "indirect.bounce1+indirect.bounce2=indirect", "direct+indirect.bounce1+indirect.bounce2=RGB", "Z"]
    {
        let json = place.json(&["image.exr", "image.exr", "--layer", layers]);
        assert_eq!((&json["frames"][0]["rmse"], &json["frames"][0]["layer"]), (&0.0.into(), &layers.into()));
    }
    let json = place.json(&["image.exr", "image.exr", "--layer", "indirect=indirect.bounce1"]);
    assert_near(&json["frames"][0]["energy"], 4.0 / 3.0);
}

#[test]
fn a_heatmap_is_black_but_where_the_error_is() {
    let place = Images::new();
    let (x, y) = (28, 9);
    place.exr("test.exr", |at, value| if at == (y * WIDTH + x) as usize { 90.0 } else { value });
    place.exr("reference.exr", |_, value| value);
    let output = place.compare(&["test.exr", "reference.exr", "--heatmap", "maps/flip.png"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let brightness = |name: &str, x, y| pixel(&place.path(name), x, y).iter().map(|&value| u32::from(value)).sum::<u32>();
    assert!(brightness("maps/flip.png", x, y) > 60, "{:?}", pixel(&place.path("maps/flip.png"), x, y));
    assert!(brightness("maps/flip.png", 3, 25) < 10);

    // A layer without FLIP is shown by its error, the largest in pale yellow; several heatmaps go into a folder.
    let output = place.compare(&["test.exr", "reference.exr", "--layer", "Z", "--layer", "RGB", "--heatmap", "all"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(brightness("all/test.exr.Z.png", x, y) > 650);
    assert!(brightness("all/test.exr.Z.png", x + 1, y) < 10);
    assert_eq!(fs::read(place.path("all/test.exr.RGB.png")).unwrap(), fs::read(place.path("maps/flip.png")).unwrap());

    fs::write(place.path("file"), "in the way").unwrap();
    failed(&place.compare(&["test.exr", "reference.exr", "--heatmap", "file/map.png"]), 6, &["file", "cannot be written"]);
}

#[test]
fn pngs_are_compared_as_light_and_seen_as_they_are() {
    let place = Images::new();
    let write = |name: &str, byte: u8| write_png(&place.path(name), 16, 16, &[byte; 16 * 16 * 3]).unwrap();
    write("half.png", 188);
    write("full.png", 255);
    let figures = &place.json(&["half.png", "full.png"])["frames"][0];
    // sRGB's 188 is half of white.
    assert!((figures["energy"].as_f64().unwrap() - 0.503).abs() < 1e-3, "{figures}");
    assert!(figures["flip"].as_f64().unwrap() > 0.1 && figures["exposures"].is_null(), "{figures}");
    place.exr_of("half.exr", 16, 16, |_, value| value);
    failed(&place.compare(&["half.png", "half.exr"]), 2, &["half.png and half.exr", "tone-mapped colours", "radiance"]);
}

#[test]
fn folders_are_compared_frame_by_frame_and_summed_up() {
    let place = Images::new();
    for (i, scale) in [1.0, 1.5, 1.2].iter().enumerate() {
        place.exr(&format!("test/frame-{i}.exr"), |_, value| value * scale);
        place.exr(&format!("reference/frame-{i}.exr"), |_, value| value);
    }
    fs::write(place.path("test/notes.txt"), "no image").unwrap();
    let output = place.compare(&["test", "reference", "--heatmap", "maps"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let stdout = text(&output.stdout);
    let starts: Vec<&str> = stdout.lines().map(|line| line.split("  ").next().unwrap()).collect();
    assert_eq!(starts, ["frame-0.exr RGB", "frame-1.exr RGB", "frame-2.exr RGB", "all RGB"]);
    assert!(place.path("maps/frame-2.exr.RGB.png").is_file());
    let json = place.json(&["test", "reference"]);
    let rmse: Vec<f64> = json["frames"].as_array().unwrap().iter().map(|frame| frame["rmse"].as_f64().unwrap()).collect();
    assert_near(&json["summary"][0]["rmse"], (rmse.iter().map(|rmse| rmse * rmse).sum::<f64>() / 3.0).sqrt());
    assert_near(&json["summary"][0]["energy"], 3.7 / 3.0);
    assert_eq!(json["summary"][0]["worst"], json["frames"][1]["worst"]);
    // Thresholds hold for each frame.
    failed(&place.compare(&["test", "reference", "--max-energy-error", "0.4"]), 1, &["frame-1.exr", "energy error"]);

    place.exr("test/frame-3.exr", |_, value| value);
    assert_eq!(failed(&place.compare(&["test", "reference"]), 2, &["reference/frame-3.exr", "missing"]), "");
    assert_eq!(failed(&place.compare(&["reference", "test"]), 2, &["reference/frame-3.exr", "missing"]), "");

    // A run's folder is replaced by its image, whatever other files it has.
    place.exr("test/image.exr", |_, value| value * 2.0);
    place.exr("reference/image.exr", |_, value| value);
    for (test, reference) in [("test", "reference"), ("test", "reference/image.exr"), ("test/image.exr", "reference")] {
        let json = place.json(&[test, reference]);
        assert_eq!(json["frames"].as_array().unwrap().len(), 1);
        assert_near(&json["frames"][0]["energy"], 2.0);
    }
}

#[test]
fn what_cannot_be_compared_ends_with_2_and_one_sentence() {
    let place = Images::new();
    place.exr("good.exr", |_, value| value);
    place.exr_of("wide.exr", 41, HEIGHT, |_, value| value);
    place.exr("nan.exr", |at, value| if at == (12 * WIDTH + 5) as usize { f32::NAN } else { value });
    place.exr("infinite.exr", |at, value| if at == 3 { f32::INFINITY } else { value });
    let whole = fs::read(place.path("good.exr")).unwrap();
    fs::write(place.path("cut.exr"), &whole[..whole.len() / 2]).unwrap();
    fs::write(place.path("text.exr"), "no image at all").unwrap();
    fs::create_dir(place.path("empty")).unwrap();
    fs::create_dir(place.path("nothing")).unwrap();
    let cases: &[(&[&str], &[&str])] = &[
        (&["missing.exr", "good.exr"], &["missing.exr: cannot be read"]),
        (&["good.exr", "text.exr"], &["text.exr: is neither an OpenEXR nor a PNG image"]),
        (&["cut.exr", "good.exr"], &["cut.exr: is not an OpenEXR image that can be read"]),
        (&["wide.exr", "good.exr"], &["wide.exr and good.exr", "41 x 30", "40 x 30"]),
        (&["nan.exr", "good.exr"], &["nan.exr: layer RGB: channel R is not a number at pixel (5, 12)"]),
        (&["good.exr", "nan.exr", "--layer", "Z"], &["nan.exr: layer Z: channel Z is not a number at pixel (5, 12)"]),
        (&["good.exr", "infinite.exr", "--json"], &["infinite.exr: layer RGB: channel R is infinite at pixel (3, 0)"]),
        (&["good.exr", "good.exr", "--layer", "indriect"], &["good.exr: has no layer indriect; did you mean indirect?", "direct,", "Z"]),
        (&["good.exr", "good.exr", "--layer", "direct+Z"], &["direct (RGB)", "Z (Z)", "cannot be added"]),
        (&["good.exr", "good.exr", "--layer", "direct=Z"], &["layer direct=Z", "radiance", "one number a pixel"]),
        (&["good.exr", "good.exr", "--layer", "Z", "--max-flip", "1"], &["layer Z has no flip"]),
        (&["good.exr", "good.exr", "--layer", "N", "--max-energy-error", "1"], &["layer N has no energy error"]),
        (&["empty", "nothing"], &["empty: has no .exr and no .png file"]),
        (&["empty", "good.exr"], &["empty: is a folder", "good.exr"]),
    ];
    for (arguments, says) in cases {
        assert_eq!(failed(&place.compare(arguments), 2, says), "", "{arguments:?}");
    }
    assert_eq!(place.compare(&["good.exr"]).status.code(), Some(2));
}
