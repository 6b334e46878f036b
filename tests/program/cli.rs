//! Tests of the program from the outside: files, exit codes, and one sentence for every error.

use crate::place::{BOX, Place, failed, text};
use manylight::output::read_exr;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn run(command: &mut Command) -> Output {
    command.output().unwrap()
}

#[track_caller]
fn succeeded(output: &Output) {
    assert_eq!(output.status.code(), Some(0), "{}{}", text(&output.stdout), text(&output.stderr));
}

/// Paths of all files below a folder; none if it does not exist.
fn files(place: &Place, folder: &str) -> Vec<String> {
    let root = place.path(folder);
    let mut files = Vec::new();
    let mut open = vec![root.clone()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                files.push(path.strip_prefix(&root).unwrap().to_string_lossy().into_owned());
            }
        }
    }
    files.sort();
    files
}

#[test]
fn a_run_leaves_a_picture_its_layers_its_times_and_its_record() {
    let place = Place::new(&[("box.toml", BOX)]);
    let config = place.path("box.toml");
    let output = run(place.manylight().args([
        "render",
        "box.toml",
        "-o",
        "out",
        "--device",
        "cpu",
        "--validate",
        "--check-nan",
        "--dump",
        "rsm/draw",
        "--dump",
        "compose/sum",
        "--set",
        "ssao.radius=0.6",
    ]));
    succeeded(&output);
    let unused = "--set ssao.radius=0.6: ssao.radius: is not used, since ssao.method is \"none\"";
    assert!(text(&output.stderr).contains(unused), "{}", text(&output.stderr));
    let stdout = text(&output.stdout);
    for part in ["gather", "gbuffer", "image.png", "median", "cpu"] {
        assert!(stdout.contains(part), "{part:?} is not in {stdout}");
    }
    let files = files(&place, "out");
    let plain: Vec<&String> = files.iter().filter(|file| !file.starts_with("dump")).collect();
    assert_eq!(plain, ["image.exr", "image.png", "run.json", "timings.csv"]);
    assert_eq!(files.len() - plain.len(), 6, "the map's three images, the sum's three: {files:?}");

    let exr = read_exr(&place.path("out/image.exr")).unwrap();
    assert_eq!((exr.width, exr.height), (64, 48));
    let names: Vec<&str> = exr.channels.keys().map(String::as_str).collect();
    let mut expected = vec!["R", "G", "B", "A", "Z", "N.X", "N.Y", "N.Z", "P.X", "P.Y", "P.Z"];
    let colors = ["albedo", "direct", "indirect", "irradiance"].map(|layer| ["R", "G", "B"].map(|c| format!("{layer}.{c}")));
    expected.extend(colors.as_flattened().iter().map(String::as_str));
    expected.sort_unstable();
    assert_eq!(names, expected);
    // The picture's layers add up: the box emits only at its lamp.
    let channel = |name: &str| &exr.channels[name];
    let sums =
        channel("R").iter().zip(channel("direct.R")).zip(channel("indirect.R")).map(|((all, direct), indirect)| all - direct - indirect);
    assert!(sums.filter(|rest| rest.abs() > 2e-3).count() < 200);
    let indirect = channel("indirect.R").iter().zip(channel("irradiance.R")).zip(channel("albedo.R"));
    assert!(
        indirect.clone().all(|((l, e), a)| (l - e * a / std::f32::consts::PI).abs() <= 2e-3 * l.max(1e-3)),
        "indirect is irradiance times albedo over pi"
    );

    let png = image::open(place.path("out/image.png")).unwrap();
    assert_eq!((png.width(), png.height()), (64, 48));
    assert_eq!(image::open(place.path("out/dump/compose.sum/compose.image.png")).unwrap(), png, "a picture is dumped as it is");

    let csv = fs::read_to_string(place.path("out/timings.csv")).unwrap();
    let rows: Vec<&str> = csv.lines().filter(|line| !line.starts_with('#')).collect();
    assert!(rows[0].starts_with("frame,pass,stage,ms"), "{csv}");
    assert!(rows.iter().any(|row| row.starts_with("1,gather/tiled,gather,")), "{csv}");

    let json: Value = serde_json::from_slice(&fs::read(place.path("out/run.json")).unwrap()).unwrap();
    assert_eq!(json["device"]["kind"], "cpu");
    assert_eq!(json["checks"]["validation"], serde_json::json!([]));
    assert_eq!(json["checks"]["check-nan"], serde_json::json!({}));
    assert_eq!(json["warnings"], serde_json::json!([unused]));
    assert_eq!(json["counts"]["vpls/count"], 64);
    assert_eq!((json["width"].as_u64(), json["frames"].as_u64(), json["warmup"].as_u64()), (Some(64), Some(2), Some(1)));

    // The record's config gives the same picture again, from any folder.
    let again: manylight::config::Config = serde_json::from_value(json["config"].clone()).unwrap();
    let again = place.write("elsewhere/again.toml", manylight::config::to_toml(&again));
    succeeded(&run(place.manylight().args([
        again.as_os_str(),
        "-o".as_ref(),
        "second".as_ref(),
        "-q".as_ref(),
        "--device".as_ref(),
        "cpu".as_ref(),
    ])));
    let [first, second] = ["out/image.png", "second/image.png"].map(|file| fs::read(place.path(file)).unwrap());
    assert!(first == second, "the pictures differ");
    let second = read_exr(&place.path("second/image.exr")).unwrap();
    assert!(second.channels == exr.channels, "the layers differ");
    assert!(config.exists());
}

#[test]
fn quiet_prints_the_pictures_place_alone_and_a_config_alone_renders() {
    let place = Place::new(&[("box.toml", BOX)]);
    let output = run(place.manylight().args(["box.toml", "--quiet", "--device", "cpu"]));
    succeeded(&output);
    assert_eq!(text(&output.stdout).trim_end(), Path::new("out/box/image.png").display().to_string());
    assert_eq!(text(&output.stderr), "");
}

#[test]
fn the_program_runs_in_any_folder_and_its_second_start_compiles_nothing() {
    let place = Place::new(&[("box.toml", BOX)]);
    let config = place.path("box.toml");
    let elsewhere = place.path("some/other/folder");
    fs::create_dir_all(&elsewhere).unwrap();
    let cached = || -> BTreeMap<PathBuf, (u64, std::time::SystemTime)> {
        let state = |file: &String| {
            let path = place.path("cache/manylight").join(file);
            let data = fs::metadata(&path).unwrap();
            (path, (data.len(), data.modified().unwrap()))
        };
        files(&place, "cache/manylight").iter().map(state).collect()
    };
    let start = |device_cache: &str| {
        let mut command = place.manylight();
        command.current_dir(&elsewhere).env("XDG_CACHE_HOME", place.path("cache")).env("MESA_SHADER_CACHE_DIR", place.path(device_cache));
        run(command.arg(&config).args(["-o", "out", "-q", "--device", "cpu"]))
    };
    succeeded(&start("mesa"));
    let first = cached();
    assert!(first.len() >= 9, "one file a shader: {first:?}");
    succeeded(&start("mesa"));
    assert_eq!(cached(), first, "the second start wrote to the cache");
    assert_eq!(files(&place, "some/other/folder/out"), ["image.exr", "image.png", "run.json", "timings.csv"]);
}

#[test]
fn list_and_doctor_say_what_there_is() {
    let place = Place::new(&[]);
    let list = run(place.manylight().arg("list"));
    succeeded(&list);
    let stdout = text(&list.stdout);
    for part in ["gather.method", "per-pixel", "vpls.sampler", "regular", "presets", "first-light", "cornell"] {
        assert!(stdout.contains(part), "list: {part:?} is not in {stdout}");
    }
    let doctor = run(place.manylight().arg("doctor"));
    succeeded(&doctor);
    let stdout = text(&doctor.stdout);
    for part in ["driver", "limits", "gather.method", "runs", "validation layer: found", "shader cache: "] {
        assert!(stdout.contains(part), "doctor: {part:?} is not in {stdout}");
    }
    assert_eq!((text(&list.stderr), text(&doctor.stderr)), (String::new(), String::new()));
}

/// A glTF file of one triangle; `change` modifies its JSON and appends to its buffer.
fn triangle(change: impl FnOnce(&mut Value, &mut Vec<u8>)) -> Vec<u8> {
    let mut json = serde_json::json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3, "min": [0.0, 0.0, 0.0], "max": [1.0, 1.0, 0.0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
    });
    let mut bin: Vec<u8> = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    change(&mut json, &mut bin);
    json["buffers"] = serde_json::json!([{"byteLength": bin.len()}]);
    let chunk = |kind: &[u8; 4], data: &[u8], pad: u8| {
        let mut data = data.to_vec();
        data.resize(data.len().next_multiple_of(4), pad);
        [&(data.len() as u32).to_le_bytes()[..], kind, &data].concat()
    };
    let body = [chunk(b"JSON", &serde_json::to_vec(&json).unwrap(), b' '), chunk(b"BIN\0", &bin, 0)].concat();
    [&b"glTF"[..], &2u32.to_le_bytes(), &(12 + body.len() as u32).to_le_bytes(), &body].concat()
}

const LIGHT: &str = "[[light]]\nkind = \"directional\"\ndirection = [0.0, 0.0, -1.0]\nirradiance = [1.0, 1.0, 1.0]\n";

#[test]
fn bad_input_ends_with_one_sentence_its_code_and_no_output() {
    let place = Place::new(&[("box.toml", BOX)]);
    place.write("good.glb", triangle(|_, _| {}));
    let whole = triangle(|_, _| {});
    place.write("cut.glb", &whole[..whole.len() - 20]);
    place.write("nothing.glb", triangle(|json, _| json["nodes"] = serde_json::json!([{}])));
    place.write(
        "picture.glb",
        triangle(|json, bin| {
            let at = bin.len();
            bin.extend_from_slice(b"\x89PNG\r\n\x1a\nand then no picture at all");
            json["bufferViews"]
                .as_array_mut()
                .unwrap()
                .push(serde_json::json!({"buffer": 0, "byteOffset": at, "byteLength": bin.len() - at}));
            json["images"] = serde_json::json!([{"bufferView": 1, "mimeType": "image/png"}]);
            json["textures"] = serde_json::json!([{"source": 0}]);
            json["materials"] = serde_json::json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}]);
            json["meshes"][0]["primitives"][0]["material"] = serde_json::json!(0);
        }),
    );
    for name in ["good", "cut", "nothing", "picture", "missing"] {
        place.write(
            &format!("{name}.toml"),
            format!("[scene]\nfile = \"{name}.glb\"\n[frame]\nsize = [32, 32]\ncount = 1\nwarmup = 0\n{LIGHT}"),
        );
    }
    place.write("dark.toml", "[scene]\nfile = \"good.glb\"\n[frame]\nsize = [32, 32]\n");
    place.write("typo.toml", "[gather]\ninterlaeve = 2\n");
    place.write("kind.toml", "[frame]\nsize = \"big\"\n");
    place.write("range.toml", "[gather]\ninterleave = 3\n");
    place.write("syntax.toml", "[frame\nsize = [1, 2]\n");
    place.write(
        "huge.toml",
        format!("{BOX}[materials]\n").replace("size = [64, 48]", "size = [16384, 16384]").replace("16384, 16384", "16385, 8"),
    );
    place.write("in-the-way", "a file where a folder should be");

    // The unmodified file renders, so each refusal is due to its modification.
    succeeded(&run(place.manylight().args(["good.toml", "-o", "good", "-q", "--device", "cpu"])));

    let cases: &[(&str, &[&str], i32, &[&str])] = &[
        ("an unknown key", &["typo.toml"], 2, &["typo.toml", "2", "interlaeve", "interleave"]),
        ("a value of the wrong type", &["kind.toml"], 2, &["kind.toml", "frame.size"]),
        ("a value out of range", &["range.toml"], 2, &["range.toml", "gather.interleave"]),
        ("a size out of range", &["huge.toml"], 2, &["huge.toml", "frame.size"]),
        ("a file that is no TOML", &["syntax.toml"], 2, &["syntax.toml", "1"]),
        ("an unknown key of --set", &["box.toml", "--set", "gather.interlaeve=2"], 2, &["gather.interlaeve", "interleave"]),
        ("a config that is not there", &["render", "nowhere.toml"], 2, &["nowhere.toml"]),
        ("a scene that is not there", &["missing.toml"], 2, &["missing.glb"]),
        ("a scene that was cut off", &["cut.toml"], 2, &["cut.glb"]),
        ("a scene without triangles", &["nothing.toml"], 2, &["nothing.glb", "triangle"]),
        ("an image that does not decode", &["picture.toml"], 2, &["picture.glb", "image"]),
        ("a scene without a light", &["dark.toml"], 2, &["light", "[[light]]"]),
        ("a pass that there is not", &["box.toml", "--dump", "gather/tilde"], 2, &["gather/tilde", "gather/tiled"]),
        ("a device that there is not", &["box.toml", "--device", "abacus"], 3, &["device"]),
    ];
    for (what, arguments, code, says) in cases {
        let mut command = place.manylight();
        command.args(*arguments).args(["-o", "refused"]);
        if !arguments.contains(&"--device") {
            command.args(["--device", "cpu"]);
        }
        failed(what, &run(&mut command), *code, says);
        assert_eq!(files(&place, "refused"), Vec::<String>::new(), "{what}");
    }
    failed(
        "an output folder under a file",
        &run(place.manylight().args(["box.toml", "-o", "in-the-way/out", "--device", "cpu"])),
        6,
        &["in-the-way"],
    );
    assert_eq!(fs::read_to_string(place.path("in-the-way")).unwrap(), "a file where a folder should be");
    let folders = ["render", "doctor"].map(|command| {
        let mut no_driver = place.manylight();
        no_driver.env("VK_ICD_FILENAMES", "/nowhere.json").env("VK_DRIVER_FILES", "/nowhere.json");
        no_driver.args(if command == "render" { &["render", "box.toml", "-o", "refused"][..] } else { &["doctor"] });
        run(&mut no_driver)
    });
    failed("rendering without any driver", &folders[0], 3, &["mesa-vulkan-drivers"]);
    assert_eq!(folders[1].status.code(), Some(3), "{}", text(&folders[1].stderr));
    assert!(text(&folders[1].stderr).contains("mesa-vulkan-drivers"));
    assert_eq!(files(&place, "refused"), Vec::<String>::new());
}

#[test]
fn a_broken_shader_is_reported_with_its_file_and_line() {
    let place = Place::new(&[("box.toml", BOX)]);
    place.copy_shaders("glsl");
    let broken = place.path("glsl/compose/sum.comp");
    let good = fs::read_to_string(&broken).unwrap();
    let line = good.lines().position(|line| line.contains("vec3 shown")).unwrap() + 1;
    let with_shaders = |folder: &str| {
        let mut command = place.manylight();
        command.env("MANYLIGHT_GLSL", place.path(folder));
        run(command.args(["box.toml", "-o", "out", "-q", "--device", "cpu"]))
    };
    succeeded(&with_shaders("glsl"));
    fs::remove_dir_all(place.path("out")).unwrap();
    fs::write(&broken, good.replace("vec3 shown = ", "vec3 shown = nonsense * ")).unwrap();
    failed("a broken shader", &with_shaders("glsl"), 2, &[&format!("compose/sum.comp:{line}:"), "nonsense"]);
    fs::remove_file(place.path("glsl/compose/sum.comp")).unwrap();
    failed("a missing shader", &with_shaders("glsl"), 2, &["compose/sum.comp"]);
    failed("a missing folder", &with_shaders("nowhere"), 2, &["MANYLIGHT_GLSL", "nowhere"]);
    assert_eq!(files(&place, "out"), Vec::<String>::new());
}

#[test]
fn an_injected_fault_ends_with_its_code_names_what_it_met_and_leaves_no_file() {
    let place = Place::new(&[("box.toml", BOX)]);
    let cases: &[(&str, i32, &[&str])] = &[
        // The pass before in the frame is the last that may have ended.
        ("device-lost:gather/tiled", 4, &["gather/tiled", "lost"]),
        ("device-lost:compose/sum", 4, &["compose/sum", "lost"]),
        ("out-of-memory:rsm/depth", 5, &["rsm/depth", "memory"]),
        ("out-of-memory:vpls/places", 5, &["vpls/places", "memory"]),
    ];
    for (fault, code, says) in cases {
        for timing in ["isolated", "serial"] {
            let mut command = place.manylight();
            command.env("MANYLIGHT_FAULT", fault);
            command.args(["box.toml", "-o", "out", "--device", "cpu", "--timing", timing]);
            failed(&format!("{fault}, {timing}"), &run(&mut command), *code, says);
            assert_eq!(files(&place, "out"), Vec::<String>::new(), "{fault}");
        }
    }
    failed(
        "a fault by no known name",
        &run(place.manylight().env("MANYLIGHT_FAULT", "flood").args(["box.toml", "--device", "cpu"])),
        2,
        &["MANYLIGHT_FAULT", "flood"],
    );
}

#[test]
fn a_config_may_have_the_name_of_the_preset_that_it_starts_from() {
    let small = "base = \"cornell\"\n[frame]\nsize = [16, 16]\n[rsm]\nsize = [32, 32]\n[vpls]\ncount = 16\n";
    let place = Place::new(&[("cornell.toml", small)]);
    place.succeeds("cornell.toml -o out -q --device cpu");
    assert!(place.path("out/image.png").exists());
}
