//! Damaged and lying animations; [`crate::hostile`] has the rest of a file.

use crate::hostile::{Case, check};
use crate::make::{Make, U8, push};
use serde_json::{Value, json};

/// An animation that moves the square by three keys; its times and values are accessors 4 and 5.
fn slide(make: &mut Make) -> &mut Value {
    make.animate(0, "translation", "LINEAR", &[0.0, 1.0, 2.0], &[0.0; 9]);
    &mut make.json["animations"][0]
}

const CASES: &[Case] = &[
    ("a channel of no node", |m| slide(m)["channels"][0]["target"]["node"] = json!(9), "animation 0: channel 0: node 9 does not exist"),
    (
        "a channel of no sampler",
        |m| slide(m)["channels"][0]["sampler"] = json!(4),
        "animation 0: channel 0: sampler 4: it does not exist, the animation has 1",
    ),
    ("a channel of no property", |m| slide(m)["channels"][0]["target"]["path"] = json!("colour"), "its path is none of translation"),
    ("a way between keys of no one", |m| slide(m)["samplers"][0]["interpolation"] = json!("BEZIER"), "none of STEP, LINEAR and"),
    ("times that are not there", |m| slide(m)["samplers"][0]["input"] = json!(99), "sampler 0: accessor 99 does not exist"),
    ("values that are not there", |m| slide(m)["samplers"][0]["output"] = json!(99), "sampler 0: accessor 99 does not exist"),
    ("positions as times", |m| slide(m)["samplers"][0]["input"] = json!(0), "its type is Vec3, which time cannot be"),
    ("times as values", |m| slide(m)["samplers"][0]["output"] = json!(4), "its type is Scalar, which translation cannot be"),
    ("too few values", |m| slide(m)["samplers"][0]["interpolation"] = json!("CUBICSPLINE"), "its 3 keys need 9 values, its output"),
    (
        "integers as places",
        |m| {
            slide(m);
            let output = m.accessor(U8, "VEC3", 3, &[0; 9]);
            m.json["accessors"][output]["normalized"] = json!(true);
            m.json["animations"][0]["samplers"][0]["output"] = json!(output);
        },
        "its components are normalized U8, which translation cannot be",
    ),
    (
        "rotations that are not normalized",
        |m| {
            m.animate(0, "rotation", "LINEAR", &[0.0], &[0.; 4]);
            let output = m.accessor(U8, "VEC4", 1, &[0; 4]);
            m.json["animations"][0]["samplers"][0]["output"] = json!(output);
        },
        "its components are U8, which rotation cannot be",
    ),
    (
        "no keys",
        |m| {
            slide(m);
            m.json["accessors"][4]["count"] = json!(0);
        },
        "sampler 0: it has no keys",
    ),
    ("a time below zero", |m| m.animate(0, "scale", "STEP", &[-1.0, 2.0], &[1.; 6]), "the time -1 of key 0 is below 0"),
    ("times that fall", |m| m.animate(0, "scale", "STEP", &[0.0, 2.0, 1.0], &[1.; 9]), "the time 1 of key 2 is below 0 or before that"),
    ("a time that is none", |m| m.animate(0, "scale", "STEP", &[0.0, f32::NAN], &[1.; 6]), "time, accessor 4: element 1 is not finite"),
    ("a value that is none", |m| m.animate(0, "scale", "STEP", &[0.0], &[f32::INFINITY; 3]), "element 0 is not finite"),
    (
        "a turn by nothing",
        |m| m.animate(0, "rotation", "LINEAR", &[0.0, 1.0], &[0., 0., 0., 1., 0., 0., 0., 0.]),
        "rotation of key 1 is not",
    ),
    (
        "two channels of one property",
        |m| {
            slide(m);
            slide(m);
        },
        "the translation of node 0 is that of another channel already",
    ),
    (
        "a matrix that is animated",
        |m| {
            slide(m);
            m.node()["matrix"] = json!([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
        },
        "node 0 has a matrix: what is animated has",
    ),
    ("a way too far", |m| m.animate(0, "translation", "LINEAR", &[0.0, 1.0], &[0., 0., 0., 0., 1e12, 0.]), "gets farther than 1e9 m"),
    (
        "a curve too far",
        |m| {
            let spline = [[0.; 3], [0.; 3], [3e38, 0., 0.], [0.; 3], [0.; 3], [0.; 3]];
            m.animate(0, "translation", "CUBICSPLINE", &[0.0, 1.0], spline.as_flattened())
        },
        "gets farther than 1e9 m",
    ),
    (
        "a flat node below one that moves",
        |m| {
            slide(m);
            m.json["nodes"] = json!([{"children": [1]}, {"mesh": 0, "rotation": [0, 0, 0, 0]}]);
        },
        "node 1: its rotation",
    ),
    (
        "a moving node that is its own child",
        |m| {
            slide(m);
            m.node()["children"] = json!([0]);
        },
        "node 0 is reached twice",
    ),
];

#[test]
fn every_lie_of_an_animation_is_named() {
    for (name, bend, expected) in CASES {
        let mut make = Make::textured(json!({}));
        bend(&mut make);
        check(name, &make.glb(), expected);
    }
}

#[test]
fn a_small_file_cannot_ask_for_many_keys_or_much_time_for_them() {
    // Many samplers share their many keys, which no bytes of the file bound.
    let mut make = Make::square();
    make.animate(0, "translation", "STEP", &[0.0], &[0.0; 3]);
    let sampler = make.json["animations"][0]["samplers"][0].clone();
    make.json["nodes"] = json!(vec![json!({}); 30]);
    make.json["nodes"][0] = json!({"mesh": 0});
    make.json["animations"][0]["samplers"] = json!(vec![sampler; 30]);
    make.json["animations"][0]["channels"] = (0..30).map(|i| json!({"sampler": i, "target": {"node": i, "path": "translation"}})).collect();
    let accessors = make.json["accessors"].as_array_mut().unwrap();
    for accessor in accessors.iter_mut().rev().take(2) {
        accessor.as_object_mut().unwrap().remove("bufferView");
        accessor["count"] = json!(1 << 20);
    }
    check("keys", &make.glb(), "with it, the animation has more than 8388608 keys");

    // Many moving nodes with many keys.
    let mut make = Make::square();
    let keys: Vec<f32> = (0..10_000).map(|i| i as f32 * 0.1).collect();
    make.animate(0, "translation", "LINEAR", &keys, &vec![1.0; 30_000]);
    make.json["nodes"] = (0..10_000).map(|i| json!({"mesh": 0, "children": [i + 1]})).collect();
    push(&mut make.json["nodes"], json!({"mesh": 0}));
    assert_eq!(make.scene().draws.len(), 10_001);
}
