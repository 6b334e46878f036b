//! Meshes that grow: imperfect shadow maps have as many points of them as of meshes that were always as large.

use crate::common::*;
use crate::make::Make;
use crate::points::WAYS;
use manylight::config::{Config, FrameConfig, VisibilityMethod};
use manylight::renderer::Renderer;
use manylight::scene::Scene;
use serde_json::{Value, json};
use std::f32::consts::FRAC_1_SQRT_2 as H;

/// A room of four metres, and two crossed plates in it on a node of this scale.
fn nodes(scale: f32) -> Value {
    let wall = |at: [f32; 3], turn: [f32; 4]| json!({"mesh": 0, "translation": at, "rotation": turn, "scale": [4, 4, 1]});
    json!([
        {"children": [1, 2, 3], "translation": [0, -0.5, 0], "scale": [scale, scale, scale]},
        {"mesh": 1, "translation": [-1, -1, 0], "scale": [2, 2, 1]},
        {"mesh": 1, "translation": [0, -1, -1], "rotation": [0, -H, 0, H], "scale": [2, 2, 1]},
        {"mesh": 1, "translation": [-1, 0.5, 1], "rotation": [-H, 0, 0, H], "scale": [2, 2, 1]},
        {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [1.5, 1.75, 1.5], "rotation": [-H, 0, 0, H]},
        {"camera": 0, "translation": [-1.2, 0.8, 1.875]},
        wall([-2.0, -2.0, -2.0], [0.0, 0.0, 0.0, 1.0]),
        wall([2.0, -2.0, 2.0], [0.0, 1.0, 0.0, 0.0]),
        wall([-2.0, -2.0, 2.0], [0.0, H, 0.0, H]),
        wall([2.0, -2.0, -2.0], [0.0, -H, 0.0, H]),
        wall([-2.0, -2.0, 2.0], [-H, 0.0, 0.0, H]),
        wall([-2.0, 2.0, -2.0], [H, 0.0, 0.0, H]),
    ])
}

/// The room; the plates grow from 2 % to their full size within the first second, if they grow.
fn room(scale: f32, grows: bool) -> Scene {
    let mut make = Make::square();
    let square = make.primitive().clone();
    make.json["materials"] = json!([
        {"pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.7, 0.7, 1], "metallicFactor": 0}},
        {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "metallicFactor": 0}, "doubleSided": true},
    ]);
    let mesh = |material: u32| {
        let mut square = square.clone();
        square["material"] = json!(material);
        json!({"primitives": [square]})
    };
    make.json["meshes"] = json!([mesh(0), mesh(1)]);
    make.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    make.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "intensity": 40, "spot": {"innerConeAngle": 0.6, "outerConeAngle": 1.0}},
    ]}});
    make.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1.4, "znear": 0.1}}]);
    make.json["scenes"][0]["nodes"] = json!([0, 4, 5, 6, 7, 8, 9, 10, 11]);
    make.json["nodes"] = nodes(scale);
    if grows {
        make.animate(0, "scale", "LINEAR", &[0.0, 1.0, 2.0], &[0.02, 0.02, 0.02, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]);
    }
    make.scene()
}

fn config() -> Config {
    let mut config = Config::default();
    config.frame.size = [96, 72];
    config.frame.fps = 2.0;
    config.rsm.size = [128, 128];
    config.vpls.count = 256;
    config.gather.interleave = 2.into();
    config.visibility.ism.point_count = 80_000;
    config
}

/// Energy of the indirect layer, a mean of some seeds, and the number of points.
fn energy(renderer: &mut Renderer, config: &Config, frame: u32) -> (f64, u64) {
    let of_seed = |seed| energy_of_seed(renderer, &Config { frame: FrameConfig { seed, ..config.frame.clone() }, ..config.clone() }, frame);
    let all: Vec<(f64, u64)> = (0..4).map(of_seed).collect();
    (all.iter().map(|(energy, _)| energy).sum::<f64>() / 4.0, all[0].1)
}

fn energy_of_seed(renderer: &mut Renderer, config: &Config, frame: u32) -> (f64, u64) {
    let rendered = render(renderer, config, frame);
    let made = rendered.counts.iter().find(|(name, _)| name == "visibility/made-points").map_or(0, |(_, count)| *count);
    assert!(rendered.counts.iter().all(|(name, count)| name != "visibility/dropped-points" || *count == 0), "points were dropped");
    (rendered.picture.unwrap().indirect.rgb().map(|rgb| f64::from(rgb.element_sum())).sum(), made)
}

#[test]
fn a_mesh_that_grows_keeps_its_points() {
    let mut config = config();
    for (frame, scale) in [(0, 0.02), (1, 0.51), (2, 1.0)] {
        let [mut moving, mut still] = [room(0.02, true), room(scale, false)].map(traced);
        config.visibility.method = VisibilityMethod::RayTraced;
        let truth = energy(&mut still, &config, frame).0;
        let rays = energy(&mut moving, &config, frame).0;
        assert!((rays / truth - 1.0).abs() < 1e-3, "scale {scale}: rays {rays}, {truth} in a still room");
        config.visibility.method = VisibilityMethod::None;
        println!("scale {scale}: without shadows {:.3}", energy(&mut still, &config, frame).0 / truth);
        config.visibility.method = VisibilityMethod::ImperfectShadowMaps;
        for (collect, points, renders) in WAYS {
            (config.visibility.ism.collect, config.visibility.ism.points, config.visibility.ism.renderer) = (collect, points, renders);
            let (expected, of_still) = energy(&mut still, &config, frame);
            let (found, of_moving) = energy(&mut moving, &config, frame);
            let [expected, found] = [expected, found].map(|energy| energy / truth);
            println!(
                "scale {scale}, {collect:?} {points:?} {renders:?}: {found:.4} of {of_moving} points, {expected:.4} of {of_still} in a still room"
            );
            assert!(
                (found - expected).abs() < 0.02,
                "scale {scale}, {collect:?} {points:?} {renders:?}: {found}, {expected} in a still room"
            );
            let counts = of_moving as f64 / of_still as f64;
            assert!((counts - 1.0).abs() < 0.1, "scale {scale}, {collect:?} {renders:?}: {of_moving} points, {of_still} in a still room");
        }
        finish(moving.gpu());
        finish(still.gpu());
    }
}
