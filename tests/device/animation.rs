//! Animated scenes: each frame is the picture of a still scene with everything at its place.

use crate::common::*;
use crate::make::{Make, push};
use manylight::config::{CameraConfig, Config, Shadows, VisibilityMethod};
use manylight::output::Picture;
use manylight::reference::Settings;
use manylight::renderer::Renderer;
use manylight::scene::Scene;
use serde_json::{Value, json};
use std::f32::consts::FRAC_1_SQRT_2;

/// Rotations: none, and a quarter turn about +Y.
const NONE: [f32; 4] = [0.0, 0.0, 0.0, 1.0];
const QUARTER: [f32; 4] = [0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2];

/// Frame, place of the arm, its rotation, height of the plate on it, shift of the light and the camera.
type Moment = (u32, [f32; 3], [f32; 4], f32, f32);

/// Frames of half a second, and the places in them: those of the keys in [`room_in_motion`], worked out by hand. The animation
/// repeats after 2 s.
const FPS: f32 = 2.0;
const FRAMES: [Moment; 5] = [
    (0, [-0.5, 0.0, 0.0], NONE, 1.0, 0.0),
    (1, [-0.25, 0.0, 0.5], NONE, 1.25, 0.125),
    (2, [0.0, 0.0, 1.0], QUARTER, 1.5, 0.25),
    (3, [0.0, 0.0, 1.0], QUARTER, 1.75, 0.375),
    (5, [-0.25, 0.0, 0.5], NONE, 1.25, 0.125),
];

/// A room of four metres, an arm that carries a plate and a glowing plate, a spot light and a camera; the numbers are those of
/// [`FRAMES`].
fn nodes(arm: [f32; 3], turn: [f32; 4], height: f32, way: f32) -> Value {
    let h = FRAC_1_SQRT_2;
    let wall = |at: [f32; 3], turn: [f32; 4]| json!({"mesh": 0, "translation": at, "rotation": turn, "scale": [4, 4, 1]});
    json!([
        {"children": [1, 2], "name": "arm", "translation": arm, "rotation": turn},
        {"mesh": 1, "translation": [0.25, -0.5, 0.25], "scale": [1, height, 1]},
        {"mesh": 2, "translation": [-0.75, -1, -0.5], "rotation": QUARTER, "scale": [0.5, 0.5, 1]},
        {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [way, 1.75, 1], "rotation": [-h, 0, 0, h]},
        {"camera": 0, "translation": [0, way, 1.875]},
        wall([-2.0, -2.0, -2.0], NONE),
        wall([2.0, -2.0, 2.0], [0.0, 1.0, 0.0, 0.0]),
        wall([-2.0, -2.0, 2.0], QUARTER),
        wall([2.0, -2.0, -2.0], [0.0, -h, 0.0, h]),
        wall([-2.0, -2.0, 2.0], [-h, 0.0, 0.0, h]),
        wall([-2.0, 2.0, -2.0], [h, 0.0, 0.0, h]),
    ])
}

fn room_with(nodes: Value) -> Make {
    let mut make = Make::square();
    let square = make.primitive().clone();
    make.json["materials"] = json!([
        {"pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.6, 0.5, 1], "metallicFactor": 0}},
        {"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.4, 0.8, 1], "metallicFactor": 0}, "doubleSided": true},
        {"emissiveFactor": [1, 0.5, 0.25], "doubleSided": true},
    ]);
    let mesh = |material: u32| {
        let mut square = square.clone();
        square["material"] = json!(material);
        json!({"primitives": [square]})
    };
    make.json["meshes"] = json!([mesh(0), mesh(1), mesh(2)]);
    make.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    make.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "intensity": 40, "spot": {"innerConeAngle": 0.5, "outerConeAngle": 0.9}},
    ]}});
    make.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1.2, "znear": 0.1}}]);
    make.json["scenes"][0]["nodes"] = json!([0, 3, 4, 5, 6, 7, 8, 9, 10]);
    make.json["nodes"] = nodes;
    make
}

/// The room with its keyframes.
fn room_in_motion() -> Scene {
    let (_, arm, turn, height, way) = FRAMES[0];
    let mut make = room_with(nodes(arm, turn, height, way));
    make.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[-0.5, 0.0, 0.0, 0.0, 0.0, 1.0]);
    make.animate(0, "rotation", "STEP", &[0.0, 1.0], [NONE, QUARTER].as_flattened());
    make.animate(1, "scale", "LINEAR", &[0.0, 2.0], &[1.0, 1.0, 1.0, 1.0, 2.0, 1.0]);
    make.animate(3, "translation", "LINEAR", &[0.0, 2.0], &[0.0, 1.75, 1.0, 0.5, 1.75, 1.0]);
    make.animate(4, "translation", "LINEAR", &[0.0, 2.0], &[0.0, 0.0, 1.875, 0.0, 0.5, 1.875]);
    make.scene()
}

/// Rooms in which nothing moves, one for each frame.
fn still_rooms() -> impl Iterator<Item = (u32, Scene)> {
    FRAMES.into_iter().map(|(frame, arm, turn, height, way)| (frame, room_with(nodes(arm, turn, height, way)).scene()))
}

fn config() -> Config {
    let mut config = Config::default();
    config.frame.size = [64, 48];
    config.frame.fps = FPS;
    config.rsm.size = [64, 64];
    config.vpls.count = 128;
    config.gather.interleave = 2.into();
    config
}

fn shot(renderer: &mut Renderer, config: &Config, frame: u32) -> Picture {
    render(renderer, config, frame).picture.unwrap()
}

/// All numbers of a picture, as bits.
fn bits(picture: &Picture) -> Vec<u32> {
    let planes = [&picture.radiance, &picture.direct, &picture.indirect, &picture.irradiance, &picture.albedo, &picture.normal];
    let planes = planes.into_iter().chain([&picture.depth]).flat_map(|plane| plane.values.iter().map(|value| value.to_bits()));
    picture.image.iter().map(|byte| u32::from(*byte)).chain(planes).collect()
}

fn compare(config: &Config, make: fn(Scene) -> Renderer) {
    let mut moving = make(room_in_motion());
    // The order is such that no frame can be a leftover of the one before.
    let mut frames: Vec<(u32, Vec<u32>)> = [5, 2, 0, 3, 1].map(|frame| (frame, bits(&shot(&mut moving, config, frame)))).into();
    finish(moving.gpu());
    drop(moving);
    frames.sort_by_key(|(frame, _)| *frame);
    for ((frame, expected), (_, found)) in still_rooms().zip(&frames) {
        let mut still = make(expected);
        assert!(bits(&shot(&mut still, config, frame)) == *found, "frame {frame}");
        finish(still.gpu());
    }
    for pair in frames[..4].windows(2) {
        assert!(pair[0].1 != pair[1].1, "frames {} and {} show the same", pair[0].0, pair[1].0);
    }
    assert!(frames[1].1 == frames[4].1, "it begins again");
}

#[test]
fn a_frame_of_a_moving_scene_is_the_picture_of_a_still_one() {
    compare(&config(), renderer);
}

#[test]
fn what_moves_is_traced_where_it_has_come_to() {
    let mut config = config();
    config.visibility.method = VisibilityMethod::RayTraced;
    config.direct.shadows = Shadows::RayTraced;
    compare(&config, traced);
}

#[test]
fn the_truth_of_a_frame_is_that_of_a_still_scene() {
    let config = config();
    let settings = |frame_index| Settings { frame_index, ..bounces(2) };
    let mut moving = traced(room_in_motion());
    // A rasterized frame in between must not affect the tracer.
    let found = [5, 0, 2].map(|frame| {
        shot(&mut moving, &config, 3);
        (frame, reference(&mut moving, &config, settings(frame), 2).texels)
    });
    finish(moving.gpu());
    drop(moving);
    for (frame, scene) in still_rooms() {
        if let Some((_, found)) = found.iter().find(|(of, _)| *of == frame) {
            let mut still = traced(scene);
            assert!(reference(&mut still, &config, settings(frame), 2).texels == *found, "frame {frame}");
            finish(still.gpu());
        }
    }
    assert!(found[1].1 != found[2].1);
}

/// Device memory does not grow by the ray structures of earlier frames.
#[test]
fn what_rays_needed_before_is_given_back() {
    let mut config = config();
    config.direct.shadows = Shadows::RayTraced;
    let mut moving = traced(room_in_motion());
    let mut in_use = |frame| {
        shot(&mut moving, &config, frame);
        moving.gpu().memory_in_use()
    };
    let first = in_use(0);
    for frame in 1..6 {
        // Draws differ by a few arguments; one copy of the hierarchy alone takes 64 KiB.
        let now = in_use(frame);
        assert!(now.abs_diff(first) < 4096, "frame {frame}: {first} bytes, then {now}");
    }
    finish(moving.gpu());
}

#[test]
fn all_frames_of_a_still_scene_are_equal() {
    let (_, scene) = still_rooms().next().unwrap();
    let mut still = renderer(scene);
    let first = bits(&shot(&mut still, &config(), 0));
    assert!([1, 2, 7].into_iter().all(|frame| bits(&shot(&mut still, &config(), frame)) == first));
    finish(still.gpu());
}

/// A config's camera keeps its near plane, which the scene's bounds set, whatever moves.
#[test]
fn the_view_does_not_tremble_with_what_moves() {
    let mut make = Make::square();
    make.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0.0, 0.0, 0.0, 50.0, 0.0, 0.0]);
    push(&mut make.json["nodes"], json!({"mesh": 0}));
    make.json["scenes"][0]["nodes"] = json!([0, 1]);
    let mut config = config();
    config.camera = Some(CameraConfig { position: Some([0.0, 0.0, 5.0]), target: Some([0.0; 3]), ..CameraConfig::default() });
    config.light = vec![directional(glam::Vec3::NEG_Z, [1.0; 3])];
    let mut moving = renderer(make.scene());
    let (first, second) = (shot(&mut moving, &config, 0), shot(&mut moving, &config, 1));
    assert_eq!(first.view, second.view);
    assert!((first.view.diagonal - 51.0f32.hypot(1.0)).abs() < 1e-2, "{}", first.view.diagonal);
    // The moving square has gone 25 metres and is out of the picture; the other square is at its old place.
    assert!(first.image == second.image && first.radiance.values.iter().any(|value| *value > 0.0));
    finish(moving.gpu());
}
