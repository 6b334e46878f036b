//! glTF animations: nodes that move, interpolation between keys, and the choice of animation.

use crate::make::{CORNERS, I8, I16, Make, U8, U16, bytes, corners, positions, push};
use glam::{Affine3A, Quat, Vec3};
use manylight::reference::scene_digest;
use manylight::scene::gltf::AnimationChoice;
use manylight::scene::{Aabb, Light, Scene};
use serde_json::json;
use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2};

fn near(a: Vec3, b: Vec3) -> bool {
    a.distance(b) < 1e-5
}

/// World position of a draw's own origin, at a time.
fn origin(scene: &mut Scene, draw: usize, seconds: f64) -> Vec3 {
    scene.set_time(seconds);
    scene.draws[draw].transform.translation.into()
}

#[test]
fn translation_rotation_and_scale_run_through_their_keys_and_begin_again() {
    let mut make = Make::square();
    *make.node() = json!({"mesh": 0, "translation": [9, 9, 9], "scale": [1, 1, 2]});
    make.animate(0, "translation", "LINEAR", &[0.0, 2.0], &[0., 0., 0., 4., 0., 0.]);
    make.animate(0, "rotation", "STEP", &[0.0, 1.0], &[0., 0., 0., 1., 0., FRAC_1_SQRT_2, 0., FRAC_1_SQRT_2]);
    let mut scene = make.scene();
    let turn = Quat::from_rotation_y(FRAC_PI_2);
    for (seconds, x, rotation) in [(0.0, 0.0, Quat::IDENTITY), (0.5, 1.0, Quat::IDENTITY), (1.0, 2.0, turn), (1.5, 3.0, turn)] {
        // The scale has no channel, and stays.
        let expected = Affine3A::from_scale_rotation_translation(Vec3::new(1.0, 1.0, 2.0), rotation, Vec3::new(x, 0.0, 0.0));
        for loops in [0.0, 2.0, 20.0] {
            scene.set_time(seconds + loops);
            let corners = positions(&scene, &scene.draws[0]);
            for (corner, own) in corners.iter().zip([0, 1, 2, 0, 2, 3].map(|i: usize| Vec3::from(CORNERS[i]))) {
                assert!(near(*corner, expected.transform_point3(own)), "{seconds} + {loops}: {corner}");
            }
        }
    }
    // A loaded scene is at time 0 of its animation, and not at its nodes' own transforms.
    assert_eq!(make.scene().draws[0].transform.translation, glam::Vec3A::ZERO);
    assert_eq!(scene.animation.as_ref().unwrap().duration, 2.0);
}

#[test]
fn a_spline_has_its_tangents_and_a_scale_its_keys() {
    let mut make = Make::square();
    // From 0 to 1 in 2 s, with a tangent of 3 a second at the beginning: at the middle 0.5 + 2 * 3 / 8.
    let spline = [[0.; 3], [0.; 3], [3., 0., 0.], [0.; 3], [1., 0., 0.], [0.; 3]];
    make.animate(0, "translation", "CUBICSPLINE", &[0.0, 2.0], spline.as_flattened());
    make.animate(0, "scale", "LINEAR", &[0.0, 2.0], &[1., 1., 1., 3., 5., 1.]);
    let mut scene = make.scene();
    assert!(near(origin(&mut scene, 0, 1.0), Vec3::new(1.25, 0.0, 0.0)));
    let size = scene.draw_bounds(&scene.draws[0]).size();
    assert!(near(size, Vec3::new(2.0, 3.0, 0.0)), "{size}");
}

#[test]
fn what_hangs_on_a_moving_node_moves_with_it_and_the_rest_stays() {
    let mut make = Make::square();
    let (half, spin) = (FRAC_1_SQRT_2, [0., 0., 0., 1., 0., FRAC_1_SQRT_2, 0., FRAC_1_SQRT_2]);
    make.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    make.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}, {"type": "directional"}]}});
    make.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
    let light = |i: u32| json!({"KHR_lights_punctual": {"light": i}});
    make.json["nodes"] = json!([
        {"children": [1, 5], "translation": [0, 1, 0]},
        {"children": [2, 3, 4], "name": "turning"},
        {"mesh": 0, "translation": [2, 0, 0]},
        {"extensions": light(0), "translation": [0, 0, -3]},
        {"camera": 0, "name": "eye", "rotation": [-half, 0, 0, half]},
        {"mesh": 0, "extensions": light(1)},
    ]);
    make.animate(1, "rotation", "LINEAR", &[0.0, 1.0], &spin);
    make.animate(4, "translation", "STEP", &[0.0, 0.75], &[0., 0., 0., 0., 7., 0.]);
    let mut scene = make.scene();
    assert_eq!(scene.moving_draws(), [true, false]);
    for (seconds, sine, cosine) in [(0.0, 0.0, 1.0), (0.5, half, half), (0.9999999, 0.0, 1.0)] {
        // The draw is two metres along the turning +X. The spot is three metres along its -Z, and shines along it.
        assert!(near(origin(&mut scene, 0, seconds), Vec3::new(2.0 * cosine, 1.0, -2.0 * sine)), "{seconds}");
        assert!(near(origin(&mut scene, 1, seconds), Vec3::Y));
        let ahead = Vec3::new(-sine, 0.0, -cosine);
        let Light::Spot { position, direction, .. } = scene.lights[0] else { panic!("{:?}", scene.lights) };
        assert!(near(position, Vec3::Y + 3.0 * ahead) && near(direction, ahead), "{seconds}: {position} {direction}");
        assert!(matches!(scene.lights[1], Light::Directional { direction, .. } if direction == Vec3::NEG_Z));
        let camera = &scene.cameras[0];
        assert!(near(camera.position, Vec3::Y) && near(camera.target, Vec3::ZERO) && near(camera.up, ahead), "{seconds}: {camera:?}");
        // Queries at a time give the same without setting it.
        assert_eq!(scene.lights, make.scene().lights_at(seconds).into_owned());
        assert_eq!(scene.cameras, make.scene().cameras_at(seconds).into_owned());
    }
    scene.set_time(0.8);
    assert!(near(scene.cameras[0].position, Vec3::new(0.0, 8.0, 0.0)), "what moves may stand on what moves");
}

#[test]
fn rotations_of_normalized_integers_are_those_of_floats() {
    let mut expected = Make::square();
    expected.animate(0, "rotation", "LINEAR", &[0.0, 1.0], &[0., 0., 0., 1., 0., 0., 1., 0.]);
    let mut expected = expected.scene();
    let cases = [
        (I8, bytes(&[0i8, 0, 0, 127, 0, 0, 127, 0])),
        (U8, bytes(&[0u8, 0, 0, 255, 0, 0, 255, 0])),
        (I16, bytes(&[0i16, 0, 0, 32767, 0, 0, 32767, 0])),
        (U16, bytes(&[0u16, 0, 0, 65535, 0, 0, 65535, 0])),
    ];
    for (component, values) in cases {
        let mut make = Make::square();
        make.animate(0, "rotation", "LINEAR", &[0.0, 1.0], &[0.0; 8]);
        let output = make.accessor(component, "VEC4", 2, &values);
        make.json["accessors"][output]["normalized"] = json!(true);
        make.json["animations"][0]["samplers"][0]["output"] = json!(output);
        let mut scene = make.scene();
        for seconds in [0.0, 0.25, 0.7] {
            scene.set_time(seconds);
            expected.set_time(seconds);
            let (found, expected) = (scene.draws[0].transform, expected.draws[0].transform);
            assert!(found.abs_diff_eq(expected, 1e-6), "{component} at {seconds}: {found:?}");
        }
    }
}

#[test]
fn an_animation_is_the_first_or_chosen_by_index_or_name_or_none() {
    let mut make = Make::square();
    *make.node() = json!({"mesh": 0, "translation": [9, 0, 0]});
    make.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[1., 0., 0., 2., 0., 0.]);
    let mut second = make.json["animations"][0].clone();
    second["name"] = json!("back");
    second["samplers"][0]["output"] = json!(make.floats("VEC3", &[5., 0., 0., 6., 0., 0.]));
    push(&mut make.json["animations"], second);
    let first = |choice: AnimationChoice| origin(&mut make.load_animation(choice).unwrap().scene, 0, 0.5).x;
    assert_eq!(first(AnimationChoice::First), 1.5);
    assert_eq!(first(AnimationChoice::Index(1)), 5.5);
    assert_eq!(first(AnimationChoice::Name("back".to_string())), 5.5);
    assert_eq!(first(AnimationChoice::None), 9.0);
    assert!(make.load_animation(AnimationChoice::None).unwrap().scene.animation.is_none());
    for (choice, wanted) in [(AnimationChoice::Index(2), "2"), (AnimationChoice::Name("forth".to_string()), "\"forth\"")] {
        let message = format!("{:#}", make.load_animation(choice).unwrap_err());
        assert_eq!(message, format!("made.glb: it has no animation {wanted}; there is animation 0, animation 1 (\"back\")"));
    }
    let message = format!("{:#}", Make::square().load_animation(AnimationChoice::Index(0)).unwrap_err());
    assert_eq!(message, "made.glb: it has no animation 0; there is none");
}

#[test]
fn an_animation_that_moves_nothing_that_is_shown_leaves_the_scene_still() {
    let mut make = Make::square();
    push(&mut make.json["nodes"], json!({"translation": [1, 0, 0]}));
    make.animate(1, "translation", "LINEAR", &[0.0, 1.0], &[0.; 6]);
    assert!(make.scene().animation.is_none(), "a node that no scene shows");
    make.json["scenes"][0]["nodes"] = json!([0, 1]);
    assert!(make.scene().animation.is_none(), "a node without anything on it");
    // An animation of one key is a pose: its values apply, and nothing moves.
    let mut make = Make::square();
    make.animate(0, "translation", "LINEAR", &[0.0], &[3., 0., 0.]);
    let scene = make.scene();
    assert!(scene.animation.is_none());
    assert_eq!(scene.draws[0].transform.translation.x, 3.0);
    // An empty animation.
    make.json["animations"] = json!([{"channels": [], "samplers": []}]);
    assert!(make.scene().animation.is_none());
}

#[test]
fn a_scene_that_moves_otherwise_is_another_scene() {
    let way = |values: &[f32], interpolation: &str| {
        let mut make = Make::square();
        make.animate(0, "translation", interpolation, &[0.0, 1.0], values);
        scene_digest(&make.scene())
    };
    let digests = [
        scene_digest(&Make::square().scene()),
        way(&[0., 0., 0., 1., 0., 0.], "LINEAR"),
        way(&[0., 0., 0., 2., 0., 0.], "LINEAR"),
        way(&[0., 0., 0., 1., 0., 0.], "STEP"),
    ];
    for (i, digest) in digests.iter().enumerate() {
        assert!(!digests[..i].contains(digest), "{i}");
    }
    assert_eq!(digests[1], way(&[0., 0., 0., 1., 0., 0.], "LINEAR"));
}

#[test]
fn weights_of_a_node_without_morph_targets_are_a_warning() {
    let mut make = Make::square();
    make.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0., 0., 0., 1., 0., 0.]);
    push(&mut make.json["animations"][0]["channels"], json!({"sampler": 0, "target": {"node": 0, "path": "weights"}}));
    let loaded = make.load().unwrap();
    assert_eq!(loaded.warnings, ["node 0 has no morph targets: the animation of their weights is not played"]);
    assert!(loaded.scene.animation.is_some());
}

#[test]
fn bounds_hold_all_of_the_way() {
    let mut make = Make::square();
    push(&mut make.json["nodes"], json!({"mesh": 0, "translation": [0, 0, -1]}));
    make.json["scenes"][0]["nodes"] = json!([0, 1]);
    // The tangents alone move the square out to x = 1 / 4 * 8 between the keys.
    let spline = [[0.; 3], [0.; 3], [8., 0., 0.], [-8., 0., 0.], [0.; 3], [0.; 3]];
    make.animate(0, "translation", "CUBICSPLINE", &[0.0, 1.0], spline.as_flattened());
    let mut scene = make.scene();
    let expected = Aabb { min: Vec3::new(0.0, 0.0, -1.0), max: Vec3::new(3.0, 1.0, 0.0) };
    for seconds in [0.0, 0.3, 0.5] {
        scene.set_time(seconds);
        let bounds = scene.bounds();
        assert!(near(bounds.min, expected.min) && near(bounds.max, expected.max), "{seconds}: {bounds:?}");
    }
}

#[test]
fn a_node_may_grow_from_nothing_and_keeps_its_front() {
    let mut make = Make::square();
    *make.node() = json!({"mesh": 0, "scale": [0, 0, 0]});
    // The node is mirrored as soon as it has a size.
    make.animate(0, "scale", "LINEAR", &[0.0, 1.0], &[0., 0., 0., -1., 1., 1.]);
    let mut scene = make.scene();
    scene.set_time(0.5);
    let found = positions(&scene, &scene.draws[0]);
    for [a, b, c] in found.as_chunks::<3>().0 {
        assert!(near((b - a).cross(c - a).normalize(), Vec3::Z), "{found:?}");
    }
    assert_eq!(corners(&scene, &scene.draws[0]).len(), 6);

    let mut make = Make::square();
    make.json["animations"] = json!([{"name": "flip", "channels": [], "samplers": []}]);
    make.animate(0, "scale", "LINEAR", &[0.0, 1.0], &[1., 1., 1., -1., 1., 1.]);
    let loaded = make.load().unwrap();
    assert_eq!(loaded.warnings, ["animation 0 (\"flip\") mirrors node 0 at times: it shows its inside then"]);
}
