//! Meshes that bend: vertices as the host bends them, and frames that are pictures of still scenes in the same shape.

use crate::common::*;
use crate::make::{F32, Make, U8, bytes, png, push};
use glam::{Quat, Vec3};
use manylight::config::{Collect, Config, Layers, PointSet, Shadows, VisibilityMethod, VplSampler};
use manylight::graph::{Execution, Timing};
use manylight::output::Picture;
use manylight::reference::Settings;
use manylight::renderer::Renderer;
use manylight::scene::gltf::AnimationChoice;
use manylight::scene::{Aabb, Scene, Vertex, gltf, pack};
use serde_json::json;
use std::f32::consts::FRAC_1_SQRT_2;
use std::io::Write;
use std::path::Path;
use std::process::Command;

const FPS: f32 = 4.0;

/// A strip of 130 vertices, more than two workgroups, with eight joints a vertex, two targets and a normal map; three nodes show it, by two
/// skins and without one.
pub fn strips() -> Scene {
    const N: usize = 130;
    let mut make = Make::empty();
    let along = |i: usize| (i / 2) as f32 / (N / 2) as f32;
    let corners: Vec<[f32; 3]> = (0..N).map(|i| [2.0 * along(i), (i % 2) as f32 * 0.4, 0.2 * (i as f32).sin()]).collect();
    let tilted: Vec<[f32; 3]> = (0..N).map(|i| Vec3::new(0.3 * (i as f32).cos(), 0.1, 1.0).normalize().to_array()).collect();
    let tangents: Vec<[f32; 4]> = (0..N).map(|i| [0.8, 0.6, 0.0, if i < 60 { 1.0 } else { -1.0 }]).collect();
    let uvs: Vec<[f32; 2]> = (0..N).map(|i| [along(i), (i % 2) as f32]).collect();
    let sets: [Vec<[u8; 4]>; 2] = [0, 4].map(|first| (0..N).map(|i| std::array::from_fn(|k| ((i + k + first) % 5) as u8)).collect());
    let weights: [Vec<[f32; 4]>; 2] =
        [1.0, 0.3].map(|scale| (0..N).map(|i| std::array::from_fn(|k| scale * (1.0 + ((i * 7 + k * 3) % 11) as f32))).collect());
    let shift = |scale: f32| (0..N).map(|i| [0.0, scale * along(i), scale * (i as f32 * 0.2).sin()]).collect::<Vec<[f32; 3]>>();
    let mut attributes = json!({
        "POSITION": make.floats("VEC3", corners.as_flattened()),
        "NORMAL": make.floats("VEC3", tilted.as_flattened()),
        "TANGENT": make.floats("VEC4", tangents.as_flattened()),
        "TEXCOORD_0": make.floats("VEC2", uvs.as_flattened()),
    });
    for (set, (joints, weights)) in sets.iter().zip(&weights).enumerate() {
        attributes[format!("JOINTS_{set}")] = json!(make.accessor(U8, "VEC4", N, joints.as_flattened()));
        attributes[format!("WEIGHTS_{set}")] = json!(make.accessor(F32, "VEC4", N, &bytes(weights.as_flattened())));
    }
    let targets = json!([
        {"POSITION": make.floats("VEC3", shift(0.5).as_flattened()), "NORMAL": make.floats("VEC3", shift(1.0).as_flattened())},
        {"POSITION": make.floats("VEC3", shift(-0.25).as_flattened())},
    ]);
    make.texture(&png(1, 1, &[140, 120, 250, 255]));
    make.json["materials"] = json!([{"normalTexture": {"index": 0}, "doubleSided": true}]);
    *make.primitive() = json!({"mode": 5, "attributes": attributes, "targets": targets, "material": 0});
    let binds: [[f32; 3]; 5] = std::array::from_fn(|i| [0.5 * i as f32, 0.0, 0.0]);
    make.skin(&[3, 4, 5, 6, 7], &binds);
    make.skin(&[7, 6, 5, 4, 3], &binds);
    let joint = |child: usize| json!({"translation": [if child > 4 { 0.5 } else { 0.0 }, 0, 0], "children": [child]});
    make.json["nodes"] = json!([
        {"mesh": 0, "skin": 0},
        {"mesh": 0, "skin": 1, "weights": [0.5, 0.25]},
        {"mesh": 0, "translation": [0, -2, 0]},
        joint(4), joint(5), joint(6), joint(7), {"translation": [0.5, 0, 0]},
        {"mesh": 1, "translation": [0, -1, 0]},
    ]);
    make.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3, 8]);
    let still = [make.floats("VEC3", crate::make::CORNERS.as_flattened()), make.floats("VEC3", [[0.0f32, 0.0, 1.0]; 4].as_flattened())];
    push(&mut make.json["meshes"], json!({"primitives": [{"mode": 5, "attributes": {"POSITION": still[0], "NORMAL": still[1]}}]}));
    for (node, axis) in [(3, Vec3::Y), (4, Vec3::Z), (5, Vec3::X), (6, Vec3::ONE.normalize())] {
        let turn = |angle: f32| Quat::from_axis_angle(axis, angle).to_array();
        make.animate(node, "rotation", "LINEAR", &[0.0, 1.0, 2.0], [turn(0.2), turn(1.4), turn(0.2)].as_flattened());
    }
    make.animate(5, "scale", "LINEAR", &[0.0, 2.0], &[1.0, 1.0, 1.0, 2.0, 0.5, 1.0]);
    make.animate(0, "weights", "LINEAR", &[0.0, 2.0], &[0.0, 1.0, 1.0, -0.5]);
    make.animate(2, "weights", "STEP", &[0.0, 1.0, 2.0], &[0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    make.scene()
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

/// Asserts that a frame's vertices are those that the host bends to, and returns the largest error in units of the scene's diagonal.
fn assert_bent(renderer: &mut Renderer, config: &Config, scene: &mut Scene, frame: u32) -> f32 {
    let rendered = dump(renderer, config, frame, &["deform/vertices"]);
    let found: Vec<Vertex> = bytemuck::pod_collect_to_vec(dumped(&rendered, "scene/vertices"));
    scene.set_time(f64::from(frame) / f64::from(config.frame.fps));
    assert_eq!(found.len(), scene.vertices.len());
    let diagonal = scene.bounds().size().length();
    let mut worst = 0.0f32;
    for (i, (found, expected)) in found.iter().zip(&scene.vertices).enumerate() {
        let error = Vec3::from(found.position).distance(expected.position.into()) / diagonal;
        worst = worst.max(error);
        assert!(error < 1e-5, "frame {frame}: vertex {i} is at {:?}, expected {:?}", found.position, expected.position);
        let [normal, wanted] = [found, expected].map(|vertex| pack::octahedral_snorm16_inverse(vertex.normal));
        assert!(normal.distance(wanted) < 3e-4, "frame {frame}: the normal of vertex {i} is {normal}, expected {wanted}");
        let [(tangent, hand), (wanted, right)] = [found, expected].map(|vertex| pack::tangent_inverse(vertex.tangent));
        assert!(tangent.distance(wanted) < 5e-4 && hand == right, "frame {frame}: vertex {i}: {tangent} {hand}, {wanted} {right}");
        assert_eq!((found.uv, found.color), (expected.uv, expected.color));
    }
    if let Some(positions) = rendered.dumps.iter().find(|dump| dump.resource == "scene/positions") {
        let positions: Vec<[f32; 3]> = bytemuck::pod_collect_to_vec(dumped(&rendered, &positions.resource));
        assert!(positions.iter().zip(&found).all(|(position, vertex)| *position == vertex.position), "frame {frame}");
    }
    worst
}

fn lit(mut config: Config) -> Config {
    config.light = vec![directional(Vec3::new(0.3, -0.8, -0.5).normalize(), [2.0; 3])];
    config.camera =
        Some(manylight::config::CameraConfig { position: Some([1.0, 0.5, 5.0]), target: Some([1.0, 0.0, 0.0]), ..Default::default() });
    config
}

#[test]
fn the_device_bends_vertices_as_the_host_does() {
    let mut scene = strips();
    let mut config = lit(config());
    let mut renderer = renderer(scene.clone());
    let mut before = Vec::new();
    for frame in [1, 5, 2, 7, 0] {
        assert_bent(&mut renderer, &config, &mut scene, frame);
        assert!(before != scene.vertices, "frame {frame}");
        before = scene.vertices.clone();
    }
    // Positions without other attributes follow once something reads them.
    config.visibility.method = VisibilityMethod::ImperfectShadowMaps;
    for frame in [3, 6] {
        assert_bent(&mut renderer, &config, &mut scene, frame);
    }
    let (passes, memory) = renderer.names(&config).unwrap();
    assert_eq!(passes[..2], ["deform/pose", "deform/vertices"]);
    assert!(!memory.iter().any(|name| name == "scene/vertices"), "the scene's own memory is not the frame's");
    finish(renderer.gpu());
}

#[test]
fn targets_bend_without_any_skin() {
    let mut make = Make::square();
    make.target([[0.0; 3], [0.0; 3], [0.0, 0.5, 1.0], [0.0, 0.0, 1.0]], None);
    make.animate(0, "weights", "LINEAR", &[0.0, 2.0], &[0.0, 1.0]);
    let mut scene = make.scene();
    let mut renderer = renderer(scene.clone());
    for frame in [5, 0, 3] {
        assert_bent(&mut renderer, &lit(config()), &mut scene, frame);
    }
    finish(renderer.gpu());
}

#[test]
fn a_scene_in_which_nothing_bends_has_no_pass_for_it() {
    let mut renderer = renderer(Make::square().scene());
    let (passes, _) = renderer.names(&lit(config())).unwrap();
    assert!(passes.iter().all(|pass| !pass.starts_with("deform")), "{passes:?}");
    finish(renderer.gpu());
}

/// Places of joints in quarters of a metre, which all arithmetic has exactly: the left one's x, the right one's x and y, and the target's
/// weight, half a second apart.
const MOMENTS: [(f32, f32, f32, f32); 4] = [(-1.0, 0.0, 0.0, 0.0), (-1.25, 0.25, 0.5, 0.5), (-1.5, 0.5, 0.0, 1.0), (-1.0, 1.0, 0.25, 0.25)];

/// A room with a plate between two joints, and one that a target alone bends.
fn room_at((left, right, up, weight): (f32, f32, f32, f32), moving: bool) -> Make {
    let mut make = Make::square();
    let square = make.primitive().clone();
    make.influences(
        0,
        [[0; 4], [1, 0, 0, 0], [0, 1, 0, 0], [0; 4]],
        [[1., 0., 0., 0.], [1., 0., 0., 0.], [0.5, 0.5, 0., 0.], [1., 0., 0., 0.]],
    );
    make.skin(&[1, 2], &[[0.0; 3], [1.0, 0.0, 0.0]]);
    make.primitive()["material"] = json!(0);
    let lifted = make.floats("VEC3", &[0., 0., 0., 0., 0., 0., 0.5, 0., 0.5, 0., 0.25, 0.]);
    let wall = |material: u32, targets: Option<usize>| {
        let mut wall = square.clone();
        wall["material"] = json!(material);
        if let Some(target) = targets {
            wall["targets"] = json!([{"POSITION": target}]);
        }
        json!({"primitives": [wall]})
    };
    push(&mut make.json["meshes"], wall(1, None));
    push(&mut make.json["meshes"], wall(2, Some(lifted)));
    make.json["materials"] = json!([
        {"pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.4, 0.8, 1], "metallicFactor": 0}, "doubleSided": true},
        {"pbrMetallicRoughness": {"baseColorFactor": [0.7, 0.6, 0.5, 1], "metallicFactor": 0}},
        {"emissiveFactor": [1, 0.5, 0.25], "doubleSided": true},
    ]);
    make.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    make.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "spot", "intensity": 40, "spot": {"innerConeAngle": 0.5, "outerConeAngle": 0.9}},
    ]}});
    make.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1.2, "znear": 0.1}}]);
    let h = FRAC_1_SQRT_2;
    let side = |at: [f32; 3], turn: [f32; 4]| json!({"mesh": 1, "translation": at, "rotation": turn, "scale": [4, 4, 1]});
    make.json["nodes"] = json!([
        {"mesh": 0, "skin": 0},
        {"translation": [left, -0.5, 0]},
        {"translation": [right, up, 0.5]},
        {"mesh": 2, "weights": [weight], "translation": [-1.5, -1.5, -0.5]},
        {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 1.75, 1], "rotation": [-h, 0, 0, h]},
        {"camera": 0, "translation": [0, 0.25, 1.875]},
        side([-2.0, -2.0, -2.0], [0.0, 0.0, 0.0, 1.0]),
        side([2.0, -2.0, 2.0], [0.0, 1.0, 0.0, 0.0]),
        side([-2.0, -2.0, 2.0], [0.0, h, 0.0, h]),
        side([2.0, -2.0, -2.0], [0.0, -h, 0.0, h]),
        side([-2.0, -2.0, 2.0], [-h, 0.0, 0.0, h]),
        side([-2.0, 2.0, -2.0], [h, 0.0, 0.0, h]),
    ]);
    make.json["scenes"][0]["nodes"] = (0..12).collect();
    if moving {
        let times = [0.0, 0.5, 1.0, 1.5, 2.0];
        let keys = |value: fn(&(f32, f32, f32, f32)) -> Vec<f32>| MOMENTS.iter().chain(&MOMENTS[..1]).flat_map(value).collect::<Vec<f32>>();
        make.animate(1, "translation", "LINEAR", &times, &keys(|m| vec![m.0, -0.5, 0.0]));
        make.animate(2, "translation", "LINEAR", &times, &keys(|m| vec![m.1, m.2, 0.5]));
        make.animate(3, "weights", "LINEAR", &times, &keys(|m| vec![m.3]));
    }
    make
}

fn bending_room() -> Scene {
    room_at(MOMENTS[0], true).scene()
}

/// The room in which nothing moves, in the shape of a moment; the loader bends it.
fn still_room(moment: usize) -> Scene {
    let loaded = room_at(MOMENTS[moment], false).load_animation(AnimationChoice::None).unwrap();
    assert!(loaded.scene.bending.is_none() && loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    loaded.scene
}

/// All numbers of a picture, as bits.
fn bits(picture: &Picture) -> Vec<u32> {
    let planes = [&picture.radiance, &picture.direct, &picture.indirect, &picture.irradiance, &picture.albedo, &picture.normal];
    let planes = planes.into_iter().chain([&picture.depth]).flat_map(|plane| plane.values.iter().map(|value| value.to_bits()));
    picture.image.iter().map(|byte| u32::from(*byte)).chain(planes).collect()
}

/// Frames of the bending room are, bit by bit, pictures of still rooms in its shape.
fn compare(change: impl Fn(&mut Config), make: fn(Scene) -> Renderer) {
    let mut config = config();
    config.frame.fps = 2.0;
    change(&mut config);
    let mut bending = make(bending_room());
    let shot = |renderer: &mut Renderer, frame: u32| bits(&render(renderer, &config, frame).picture.unwrap());
    // The order is such that no frame can be a leftover of the one before.
    let frames: Vec<(u32, Vec<u32>)> = [2, 0, 3, 1].map(|frame| (frame, shot(&mut bending, frame))).into();
    finish(bending.gpu());
    drop(bending);
    for (frame, found) in &frames {
        let mut still = make(still_room(*frame as usize));
        assert!(shot(&mut still, *frame) == *found, "frame {frame}");
        finish(still.gpu());
    }
    for pair in frames.windows(2) {
        assert!(pair[0].1 != pair[1].1, "frames {} and {} show the same", pair[0].0, pair[1].0);
    }
}

#[test]
fn a_frame_of_a_bending_scene_is_the_picture_of_a_still_one() {
    compare(|_| {}, renderer);
}

#[test]
fn further_bounces_see_what_is_bent() {
    let change = |config: &mut Config| {
        config.bounce.count = 2;
        config.bounce.vpls = 64;
        config.vpls.sampler = VplSampler::Regular;
    };
    compare(change, renderer);
}

#[test]
fn rays_meet_what_is_bent() {
    let change = |config: &mut Config| {
        config.visibility.method = VisibilityMethod::RayTraced;
        config.direct.shadows = Shadows::RayTraced;
    };
    compare(change, traced);
}

#[test]
fn the_truth_of_a_bending_scene_is_that_of_a_still_one() {
    let mut config = config();
    config.frame.fps = 2.0;
    let settings = |frame_index| Settings { frame_index, ..bounces(2) };
    let mut bending = traced(bending_room());
    // A rasterized frame in between must not affect the tracer.
    let found = [3, 1].map(|frame| {
        render(&mut bending, &config, 2);
        (frame, reference(&mut bending, &config, settings(frame), 2).texels)
    });
    finish(bending.gpu());
    drop(bending);
    for (frame, found) in found {
        let mut still = traced(still_room(frame as usize));
        assert!(reference(&mut still, &config, settings(frame), 2).texels == found, "frame {frame}");
        finish(still.gpu());
    }
}

/// Points of imperfect shadow maps are made from bent triangles, by either way of collecting them.
#[test]
fn points_lie_on_what_is_bent() {
    let mut scene = bending_room();
    let mut config = config();
    config.frame.fps = 2.0;
    config.visibility.method = VisibilityMethod::ImperfectShadowMaps;
    config.visibility.ism.point_count = 20_000;
    let mut renderer = renderer(scene.clone());
    for (collect, pass) in [(Collect::Compute, "visibility/points-computed"), (Collect::Tessellation, "visibility/points-tessellated")] {
        config.visibility.ism.collect = collect;
        for frame in [0, 3] {
            let rendered = dump(&mut renderer, &config, frame, &[pass]);
            scene.set_time(f64::from(frame) / 2.0);
            // The plate is all that is in this part of the room.
            let plate = scene.draw_bounds(&scene.draws[0]);
            let words: Vec<u32> = words(dumped(&rendered, "visibility/points")).collect();
            let places = words.as_chunks::<4>().0.iter().filter(|point| point[3] != 0);
            let places: Vec<Vec3> = places.map(|[x, y, z, _]| Vec3::from([*x, *y, *z].map(f32::from_bits))).collect();
            let inside = |place: &&Vec3| place.y > -1.0 && place.z > -0.25 && place.abs().max_element() < 1.99;
            let on: Vec<&Vec3> = places.iter().filter(inside).collect();
            assert!(on.len() > 50, "{collect:?}, frame {frame}: {} points", on.len());
            let slack = Vec3::splat(1e-4);
            let held = on.iter().filter(|place| place.cmpge(plate.min - slack).all() && place.cmple(plate.max + slack).all()).count();
            assert_eq!(held, on.len(), "{collect:?}, frame {frame}: {plate:?}");
            let reach = Aabb::of(on.into_iter().copied());
            assert!((reach.max - plate.max).abs().max_element() < 0.15, "{collect:?}, frame {frame}: {reach:?} in {plate:?}");
        }
    }
    finish(renderer.gpu());
}

/// The barriers that hazards need suffice; validation watches.
#[test]
fn overlapping_passes_wait_for_bent_vertices() {
    let mut config = lit(config());
    config.visibility.method = VisibilityMethod::ImperfectShadowMaps;
    config.visibility.ism.points = PointSet::Adaptive;
    config.bounce.count = 2;
    config.bounce.clusters.layers = Layers::default();
    let mut renderer = renderer(strips());
    let mut shot = |timing, frame| {
        let execution = Execution { timing, ..Execution::default() };
        renderer.render(&config, frame, true, &execution).unwrap_or_else(|error| panic!("{error:#}")).picture.unwrap()
    };
    for frame in [4, 1] {
        let isolated = bits(&shot(Timing::Isolated, frame));
        assert!(bits(&shot(Timing::Overlapped, frame)) == isolated, "frame {frame}");
    }
    finish(renderer.gpu());
}

fn figure() -> Scene {
    let loaded = gltf::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/figure.glb"), None).unwrap();
    assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
    loaded.scene
}

#[test]
fn the_figure_bends_with_four_and_eight_joints_a_vertex_and_breathes() {
    let mut scene = figure();
    let bending = scene.bending.clone().unwrap();
    let fours: Vec<u32> = bending.meshes.iter().map(|mesh| mesh.skin.unwrap().fours).collect();
    assert_eq!(fours, [1, 2]);
    let mut config = config();
    config.frame.fps = 3.0;
    let mut renderer = renderer(scene.clone());
    for frame in [0, 2, 7] {
        assert_bent(&mut renderer, &config, &mut scene, frame);
    }
    finish(renderer.gpu());
    scene.set_time(1.0);
    assert_eq!(scene.bending.as_ref().unwrap().pose.weights, [[1.0], [1.0]]);
}

/// The armadillo from the folder beside the project, twisted by morph targets by a tool of ours.
#[test]
fn the_armadillo_twists() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes/armadillo.glb");
    let folder = tempfile::tempdir().unwrap();
    let twisted = folder.path().join("twisted.glb");
    let tool = Path::new(env!("CARGO_MANIFEST_DIR")).join("tools/add-twist");
    if !shared.exists() {
        // Written directly, since the test harness hides the printed output of passing tests.
        writeln!(std::io::stderr(), "SKIPPED: {} is not there", shared.display()).unwrap();
        return;
    }
    match Command::new("python3").arg(tool).arg(&shared).arg(&twisted).args(["--degrees", "90", "--steps", "2"]).output() {
        Ok(output) => assert!(output.status.success(), "{output:?}"),
        Err(error) => {
            writeln!(std::io::stderr(), "SKIPPED: python3, which the tool needs: {error}").unwrap();
            return;
        }
    }
    let loaded = gltf::load(&twisted, None).unwrap();
    assert_eq!(loaded.warnings, Vec::<String>::new());
    let mut scene = loaded.scene;
    let mut config = lit(config());
    let rest = scene.clone();
    let mut renderer = renderer(scene.clone());
    config.frame.fps = 1.0;
    for frame in [1, 2] {
        assert_bent(&mut renderer, &config, &mut scene, frame);
    }
    finish(renderer.gpu());
    // After a second it is twisted as far as it goes: its top by a quarter turn about the axis, and its foot not at all.
    scene.set_time(1.0);
    let draw = &scene.draws[0];
    let bounds = rest.draw_bounds(draw);
    let (middle, height) = (bounds.center(), bounds.size().y);
    for (before, after) in rest.draw_vertices(draw).zip(scene.draw_vertices(draw)) {
        let [from, to] = [before, after].map(|vertex| Vec3::from(vertex.position) - middle.with_y(bounds.min.y));
        let turned = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2 * from.y / height) * from;
        assert!(turned.distance(to) < 1e-4, "{from} went to {to}, expected {turned}");
    }
}
