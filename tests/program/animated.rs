//! Animated glTF files in the program: sequences, flicker, references and exports show each frame's time.

use crate::make::{Make, push};
use crate::place::Place;
use serde_json::json;
use std::fs;
use std::path::PathBuf;

const CONFIG: &str = "[scene]\nfile = \"slide.glb\"\n[frame]\nsize = [48, 36]\ncount = 3\nfps = 1\nwarmup = 0\n[rsm]\nsize = [32, 32]\n\
                      [vpls]\ncount = 32\n[[light]]\nkind = \"directional\"\ndirection = [0, -1, -2]\nirradiance = [3, 3, 3]\n";

/// A square that slides before another one: to the right in the file's first animation, upwards in its second.
fn slide() -> Place {
    let mut make = Make::square();
    make.json["nodes"] = json!([
        {"mesh": 0, "translation": [-3, -3, -1], "scale": [6, 6, 1]},
        {"mesh": 0, "name": "slide"},
        {"camera": 0, "translation": [0, 0, 4]},
    ]);
    make.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    make.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
    make.animate(1, "translation", "LINEAR", &[0.0, 4.0], &[-1.5, -0.5, 0.0, 1.5, -0.5, 0.0]);
    make.json["animations"][0]["name"] = json!("right");
    let mut up = make.json["animations"][0].clone();
    up["name"] = json!("up");
    up["samplers"][0]["output"] = json!(make.floats("VEC3", &[-1.5, -0.5, 0.0, -1.5, 1.5, 0.0]));
    push(&mut make.json["animations"], up);
    let place = Place::new(&[("slide.toml", CONFIG)]);
    place.write("slide.glb", make.glb());
    place
}

/// The pictures of a sequence of three frames.
fn frames(place: &Place, folder: &str) -> [Vec<u8>; 3] {
    [0, 1, 2].map(|frame| place.read(&format!("{folder}/frames/{frame:04}.png")))
}

#[test]
fn a_sequence_shows_each_frames_time() {
    let place = slide();
    let [_, warnings] = place.says("render slide.toml --sequence -o right");
    assert!(!warnings.contains("warning"), "{warnings}");
    let right = frames(&place, "right");
    assert!(right[0] != right[1] && right[1] != right[2]);
    // Ray-traced pictures move too; they differ in the soft edges of the shadow map.
    place.succeeds("render slide.toml --sequence -o rays --set direct.shadows=\"ray-traced\" --set visibility.method=\"ray-traced\"");
    let rays = frames(&place, "rays");
    assert!(rays[0] != rays[1] && rays[1] != rays[2]);
    // A single picture equals the sequence's frame at the same time, for the last frame and for another frame rate.
    place.succeeds("render slide.toml -o last");
    assert!(place.read("last/image.png") == right[2]);
    place.succeeds("render slide.toml --set frame.count=5 --set frame.fps=2 -o twice");
    assert!(place.read("twice/image.png") == right[2]);
    // The animation repeats after its four seconds.
    place.succeeds("render slide.toml --set frame.count=6 -o again");
    assert!(place.read("again/image.png") == right[1]);
}

#[test]
fn an_animation_is_chosen_by_name_or_index_or_left_out() {
    let place = slide();
    for (choice, folder) in [("\"right\"", "right"), ("1", "one"), ("\"up\"", "up"), ("\"none\"", "none")] {
        place.succeeds(&format!("render slide.toml --sequence -o {folder} --set scene.animation={choice}"));
    }
    let [right, one, up, none] = ["right", "one", "up", "none"].map(|folder| frames(&place, folder));
    assert!(one == up && up[0] == right[0] && up[1] != right[1]);
    assert!(none[0] == none[1] && none[1] == none[2] && none[0] != right[0]);
    let there_is = "slide.glb: it has no animation \"left\"; there is animation 0 (\"right\"), animation 1 (\"up\")";
    place.refuses("render slide.toml --set scene.animation=\"left\"", &[there_is]);
    place.refuses("export mitsuba slide.toml --set scene.animation=2", &["it has no animation 2; there is animation 0"]);
}

#[test]
fn a_walk_in_which_only_the_scene_moves_is_one() {
    let place = slide();
    let [stdout, stderr] = place.says("flicker slide.toml -o walk");
    assert!(!stderr.contains("nothing moves"), "{stderr}");
    assert!(!stdout.contains("flicker 0 "), "the square's shadow and light move: {stdout}");
    let [_, stderr] = place.says("flicker slide.toml -o still --set scene.animation=\"none\"");
    assert!(stderr.contains("nothing moves"), "{stderr}");
}

#[test]
fn a_reference_is_of_its_frame_and_of_its_animation() {
    let place = slide();
    place.succeeds("reference slide.toml --sequence --spp 2 --bounces 1 -o all");
    let all = frames(&place, "all");
    assert!(all[0] != all[1] && all[1] != all[2]);
    place.succeeds("reference slide.toml --frame 1 --spp 2 --bounces 1 -o one");
    assert!(place.read("one/image.png") == all[1]);
    let again = "reference slide.toml --frame 1 --spp 4 --bounces 1 -o one --resume";
    place.refuses(&format!("{again} --set scene.animation=\"up\""), &["one/sums.exr"]);
    place.succeeds(again);
}

#[test]
fn an_export_is_of_the_frame_that_is_asked_for() {
    let place = slide();
    let scene = |arguments: &str| {
        place.succeeds(&format!("export mitsuba slide.toml -o out {arguments}"));
        let mut files: Vec<PathBuf> = fs::read_dir(place.path("out/meshes")).unwrap().map(|entry| entry.unwrap().path()).collect();
        files.sort();
        let meshes = files.iter().map(|file| fs::read(file).unwrap()).collect::<Vec<_>>();
        fs::remove_dir_all(place.path("out/meshes")).unwrap();
        (place.read("out/scene.xml"), meshes)
    };
    let (first, last) = (scene("--frame 0"), scene(""));
    assert!(first != last);
    assert!(last == scene("--frame 2") && first == scene("--frame 4"));
}
