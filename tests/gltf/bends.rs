//! Meshes that bend: skins, morph targets, and what bounds them.

use crate::make::{CORNERS, F32, Make, U8, U16, bytes, corners, normals, positions, push};
use glam::{Quat, Vec3};
use manylight::reference::scene_digest;
use manylight::scene::gltf::AnimationChoice;
use manylight::scene::{Aabb, Scene};
use serde_json::json;
use std::f32::consts::FRAC_PI_2;

const INDICES: [usize; 6] = [0, 1, 2, 0, 2, 3];

/// Asserts where the square's corners are, through its triangles.
fn assert_corners(scene: &Scene, draw: usize, expected: [[f32; 3]; 4], what: &str) {
    let found = positions(scene, &scene.draws[draw]);
    for (found, i) in found.iter().zip(INDICES) {
        assert!(found.distance(expected[i].into()) < 1e-4, "{what}: corner {i} is at {found}, expected {:?}", expected[i]);
    }
}

fn stretched_by(x: f32) -> [[f32; 3]; 4] {
    [[0.0, 0.0, 0.0], [1.0 + x, 0.0, 0.0], [1.0 + x, 1.0, 0.0], [0.0, 1.0, 0.0]]
}

fn at(make: &Make, seconds: f64) -> Scene {
    let mut scene = make.scene();
    scene.set_time(seconds);
    scene
}

#[test]
fn a_skin_follows_its_joints_and_not_its_node() {
    let mut scene = Make::stretched().scene();
    assert_corners(&scene, 0, stretched_by(0.0), "as loaded");
    for (seconds, x) in [(1.0, 2.0), (0.5, 1.0), (2.5, 1.0), (0.0, 0.0)] {
        scene.set_time(seconds);
        assert_corners(&scene, 0, stretched_by(x), &format!("at {seconds}"));
    }
    assert_eq!(scene.moving_draws(), [true]);
    // Only the vertices are left behind by a pose.
    scene.pose(1.0);
    assert_corners(&scene, 0, stretched_by(0.0), "posed");
    scene.bend();
    assert_corners(&scene, 0, stretched_by(2.0), "bent");
}

#[test]
fn joints_and_weights_of_all_types_are_the_same_and_sum_to_one() {
    let halves = [[0.5, 0.5, 0.0, 0.0], [0.25, 0.25, 0.0, 0.0], [3.0, 3.0, 0.0, 0.0], [1e-20, 1e-20, 0.0, 0.0f32]];
    let mut floats = Make::stretched();
    floats.influences(0, [[0, 1, 0, 0]; 4], halves);
    let mut bytes_ = Make::stretched();
    bytes_.attribute("JOINTS_0", U16, "VEC4", &bytes([[0u16, 1, 0, 0]; 4].as_flattened()));
    let weights = bytes_.attribute("WEIGHTS_0", U8, "VEC4", [[255u8, 255, 0, 0]; 4].as_flattened());
    bytes_.json["accessors"][weights]["normalized"] = json!(true);
    let mut words = Make::stretched();
    words.attribute("JOINTS_0", U8, "VEC4", [[0u8, 1, 0, 0]; 4].as_flattened());
    let weights = words.attribute("WEIGHTS_0", U16, "VEC4", &bytes([[65535u16, 65535, 0, 0]; 4].as_flattened()));
    words.json["accessors"][weights]["normalized"] = json!(true);
    // All corners go half of the way.
    let expected = CORNERS.map(|[x, y, z]| [x + 1.0, y, z]);
    for (make, name) in [(&floats, "floats"), (&bytes_, "bytes"), (&words, "words")] {
        assert_corners(&at(make, 1.0), 0, expected, name);
    }
}

#[test]
fn eight_joints_bend_a_vertex_and_a_second_set_of_nothing_costs_nothing() {
    let mut make = Make::stretched();
    make.influences(0, [[0; 4]; 4], [[0.25; 4]; 4]);
    make.influences(1, [[1; 4]; 4], [[0.0; 4], [0.75, 0.0, 0.0, 0.0], [0.25, 0.25, 0.25, 0.25], [1.0, 1.0, 0.5, 0.5]]);
    let shares = [0.0, 0.75 / 1.75, 0.5, 0.75];
    let expected = std::array::from_fn(|i| [CORNERS[i][0] + 2.0 * shares[i], CORNERS[i][1], 0.0]);
    let scene = at(&make, 1.0);
    assert_corners(&scene, 0, expected, "eight");
    assert_eq!(scene.bending.as_ref().unwrap().influences.len(), 8);
    make.influences(0, [[1; 4]; 4], [[0.25; 4]; 4]);
    make.influences(1, [[0; 4]; 4], [[0.0; 4]; 4]);
    let scene = at(&make, 1.0);
    assert_corners(&scene, 0, CORNERS.map(|[x, y, z]| [x + 2.0, y, z]), "four");
    assert_eq!(scene.bending.as_ref().unwrap().influences.len(), 4);
}

#[test]
fn normals_and_tangents_turn_with_the_joints_and_normals_are_not_sheared() {
    let mut make = Make::square();
    make.attribute("TANGENT", F32, "VEC4", &bytes([[1.0f32, 0.0, 0.0, -1.0]; 4].as_flattened()));
    make.attribute("TEXCOORD_0", F32, "VEC2", &[0; 32]);
    make.texture(&crate::make::png(1, 1, &[128, 128, 255, 255]));
    make.json["materials"] = json!([{"normalTexture": {"index": 0}}]);
    make.primitive()["material"] = json!(0);
    make.influences(0, [[0; 4]; 4], [[1.0, 0.0, 0.0, 0.0]; 4]);
    make.skin(&[1], &[[0.0; 3]]);
    make.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {"children": [2], "scale": [1, 1, 8]}, {}]);
    make.json["scenes"][0]["nodes"] = json!([0, 1]);
    // The joint turns about +Y below a node that stretches along +Z.
    make.json["skins"][0]["joints"] = json!([2]);
    let turn = Quat::from_rotation_y(FRAC_PI_2 / 2.0);
    let none = [0.0, 0.0, 0.0, 1.0];
    make.animate(2, "rotation", "LINEAR", &[0.0, 1.0], [none, turn.to_array()].as_flattened());
    let scene = at(&make, 0.9999);
    // (x, z) of the turned square is (1, -1) s, stretched to (1, -8): its normal is (8, 1) and its tangent (1, -8).
    let (normal, tangent) = (Vec3::new(8.0, 0.0, 1.0).normalize(), Vec3::new(1.0, 0.0, -8.0).normalize());
    for (vertex, found) in corners(&scene, &scene.draws[0]).iter().zip(normals(&scene, &scene.draws[0])) {
        assert!(found.distance(normal) < 1e-3, "{found}");
        let (found, handedness) = manylight::scene::pack::tangent_inverse(vertex.tangent);
        assert!(found.distance(tangent) < 1e-3 && handedness == -1.0, "{found} {handedness}");
    }
}

/// The square with a target that lifts its upper corners towards the viewer and turns their normals up.
fn lifted() -> Make {
    let mut make = Make::square();
    let up = [[0.0; 3], [0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]];
    make.target(up, Some([[0.0, 1.0, 0.0]; 4]));
    make.target([[-1.0, 0.0, 0.0]; 4], None);
    make
}

fn lifted_by(z: f32, x: f32) -> [[f32; 3]; 4] {
    std::array::from_fn(|i| [CORNERS[i][0] - x, CORNERS[i][1], if i > 1 { z } else { 0.0 }])
}

#[test]
fn weights_of_targets_are_the_nodes_then_the_meshs_then_nothing() {
    let mut make = lifted();
    let plain = make.scene();
    assert_corners(&plain, 0, CORNERS, "without weights");
    let without = Make { json: json_without_targets(&make), bin: make.bin.clone() };
    assert_eq!(scene_digest(&plain), scene_digest(&without.scene()), "unused targets change nothing");
    make.json["meshes"][0]["weights"] = json!([0.5, 0]);
    let scene = make.scene();
    assert_corners(&scene, 0, lifted_by(0.5, 0.0), "of the mesh");
    assert!(scene.bending.is_none() && scene.animation.is_none(), "a shape that does not change is baked");
    for normal in normals(&scene, &scene.draws[0]) {
        assert!(normal.distance(Vec3::new(0.0, 0.5, 1.0).normalize()) < 1e-4, "{normal}");
    }
    make.node()["weights"] = json!([-0.25, 2.0]);
    assert_corners(&make.scene(), 0, lifted_by(-0.25, 2.0), "of the node");
}

fn json_without_targets(make: &Make) -> serde_json::Value {
    let mut json = make.json.clone();
    json["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("targets");
    json
}

#[test]
fn weights_run_through_their_keys_in_steps_lines_and_splines() {
    let times = [0.0, 2.0];
    let steps = [0.25, 0.0, 1.0, 0.5];
    // Level tangents, values of two targets, level tangents.
    let spline = [0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0.];
    for (interpolation, values, seconds, lift, shift) in [
        ("STEP", &steps[..], 1.0, 0.25, 0.0),
        ("LINEAR", &steps[..], 0.5, 0.4375, 0.125),
        ("CUBICSPLINE", &spline[..], 0.5, 0.15625, 0.84375),
    ] {
        let mut make = lifted();
        make.animate(0, "weights", interpolation, &times, values);
        let scene = at(&make, seconds);
        assert_corners(&scene, 0, lifted_by(lift, shift), interpolation);
        assert!(scene.animation.is_some() && scene.bending.is_some());
        assert_corners(&at(&make, seconds + 4.0), 0, lifted_by(lift, shift), "in a loop");
    }
    // Normalized bytes, and a matrix on the node, which only other properties exclude.
    let mut make = lifted();
    make.animate(0, "weights", "LINEAR", &times, &steps);
    let output = make.accessor(U8, "SCALAR", 4, &[0, 0, 255, 0]);
    make.json["accessors"][output]["normalized"] = json!(true);
    make.json["animations"][0]["samplers"][0]["output"] = json!(output);
    make.node()["matrix"] = json!([2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]);
    assert_corners(&at(&make, 1.0), 0, lifted_by(0.5, 0.0).map(|corner| corner.map(|c| 2.0 * c)), "bytes under a matrix");
}

#[test]
fn targets_may_be_sparse_and_come_before_joints() {
    let mut make = Make::stretched();
    make.target([[0.0; 3]; 4], None);
    let target = make.primitive()["targets"][0]["POSITION"].as_u64().unwrap() as usize;
    let (indices, values) = (make.view(&[2]), make.view(&bytes(&[0.0f32, 3.0, 0.0])));
    make.json["accessors"][target] = json!({"componentType": F32, "type": "VEC3", "count": 4, "sparse": {
        "count": 1, "indices": {"bufferView": indices, "componentType": U8}, "values": {"bufferView": values}}});
    make.animate(0, "weights", "LINEAR", &[0.0, 2.0], &[0.0, 1.0]);
    // The joint of the right side turns by a quarter about +Z: what the target lifts goes to the left.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    make.animate(2, "rotation", "STEP", &[0.0], &[0.0, 0.0, half, half]);
    let expected = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0 - 1.0 - 1.5, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert_corners(&at(&make, 1.0), 0, expected, "lifted, then turned");
}

#[test]
fn flat_normals_follow_a_target() {
    let mut make = lifted();
    make.primitive()["attributes"].as_object_mut().unwrap().remove("NORMAL");
    make.json["meshes"][0]["weights"] = json!([1.0, 0.0]);
    let scene = make.scene();
    assert_corners(&scene, 0, lifted_by(1.0, 0.0), "flat");
    for normal in normals(&scene, &scene.draws[0]) {
        assert!(normal.distance(Vec3::new(0.0, -1.0, 1.0).normalize()) < 1e-4, "{normal}");
    }
}

#[test]
fn instances_share_what_was_modelled_and_bend_by_skins_of_their_own() {
    let mut make = Make::stretched();
    // A second skin, whose second joint does not move, and a third node with the first skin.
    make.skin(&[1, 3], &[[0.0; 3], [1.0, 0.0, 0.0]]);
    push(&mut make.json["nodes"], json!({"translation": [1, 7, 0]}));
    push(&mut make.json["nodes"], json!({"mesh": 0, "skin": 1}));
    push(&mut make.json["nodes"], json!({"mesh": 0, "skin": 0}));
    make.json["nodes"][1]["children"] = json!([2, 3]);
    make.json["scenes"][0]["nodes"] = json!([0, 1, 4, 5]);
    make.animate(1, "translation", "LINEAR", &[0.0, 2.0], &[0., 0., 0., 0., 0., 2.]);
    let scene = at(&make, 1.0);
    let moved = |corners: [[f32; 3]; 4]| corners.map(|[x, y, z]| [x, y, z + 1.0]);
    assert_corners(&scene, 0, moved(stretched_by(2.0)), "first");
    assert_corners(&scene, 1, moved([[0.0, 0.0, 0.0], [1.0, 7.0, 0.0], [1.0, 8.0, 0.0], [0.0, 1.0, 0.0]]), "second");
    assert_corners(&scene, 2, moved(stretched_by(2.0)), "third");
    let bending = scene.bending.as_ref().unwrap();
    assert_eq!((bending.rest.len(), bending.influences.len(), scene.vertices.len(), scene.indices.len()), (4, 4, 12, 6));
}

#[test]
fn a_skin_without_motion_is_baked_and_one_of_the_chosen_animation_alone_bends() {
    let make = Make::stretched();
    let loaded = make.load_animation(AnimationChoice::None).unwrap();
    assert!(loaded.scene.bending.is_none() && loaded.scene.animation.is_none() && loaded.warnings.is_empty());
    assert_corners(&loaded.scene, 0, stretched_by(0.0), "held still");
    // A pose of one key.
    let mut make = Make::stretched();
    make.json["animations"] = json!([{"channels": [], "samplers": []}]);
    make.animate(2, "translation", "LINEAR", &[0.0], &[4., 0., 0.]);
    let scene = make.scene();
    assert!(scene.bending.is_none() && scene.animation.is_none());
    assert_corners(&scene, 0, stretched_by(3.0), "posed");
}

#[test]
fn joints_that_mirror_keep_the_front_and_joints_of_no_size_are_joints() {
    let mut make = Make::stretched();
    make.json["nodes"][1]["scale"] = json!([-1, 1, 1]);
    let scene = at(&make, 1.0);
    for [a, b, c] in positions(&scene, &scene.draws[0]).as_chunks::<3>().0 {
        assert!((*b - *a).cross(*c - *a).z > 0.0, "the front faces +Z");
    }
    for normal in normals(&scene, &scene.draws[0]) {
        assert!(normal.distance(Vec3::Z) < 1e-4, "{normal}");
    }
    // A joint that is scaled to nothing hides what it holds, and a warning says so.
    let mut make = Make::stretched();
    make.json["nodes"][1]["scale"] = json!([0, 0, 0]);
    let loaded = make.load().unwrap();
    assert_eq!(loaded.warnings, ["node 1 has a scale of zero: it and all below it are left out"]);
    assert_corners(&loaded.scene, 0, [[0.0; 3]; 4], "hidden");
}

#[test]
fn what_is_odd_is_a_warning() {
    let mut make = Make::stretched();
    make.influences(0, [[1, 0, 0, 0]; 4], [[0.0; 4]; 4]);
    let mut loaded = make.load().unwrap();
    assert_eq!(loaded.warnings, ["some vertices have a skin and no weights: they follow the first of their joints"]);
    loaded.scene.set_time(1.0);
    assert_corners(&loaded.scene, 0, CORNERS.map(|[x, y, z]| [x + 2.0, y, z]), "weightless");
    let mut make = Make::stretched();
    for set in 1..4 {
        make.influences(set, [[1; 4]; 4], [[1.0; 4]; 4]);
    }
    let warnings = make.load().unwrap().warnings;
    assert_eq!(warnings, ["some vertices have more than eight joints: those of JOINTS_2 and after do not bend them"]);
}

/// A strip of many small triangles on a chain of joints that curls, with a target that widens it.
fn curl() -> Scene {
    const N: usize = 400;
    let mut make = Make::empty();
    let place = |i: usize| [(i / 2) as f32 * 0.01, (i % 2) as f32 * 0.3, 0.0f32];
    let strip: Vec<[f32; 3]> = (0..N).map(place).collect();
    let joint = |i: usize| (place(i)[0] / 0.5).min(3.0);
    let joints: Vec<[u8; 4]> = (0..N).map(|i| [joint(i) as u8, (joint(i) as u8 + 1).min(3), 0, 0]).collect();
    let weights: Vec<[f32; 4]> = (0..N).map(|i| [1.0 - joint(i).fract(), joint(i).fract(), 0.0, 0.0]).collect();
    let wide: Vec<[f32; 3]> = (0..N).map(|i| [0.0, place(i)[1] - 0.15, (i as f32 * 0.1).sin()]).collect();
    let positions = make.floats("VEC3", strip.as_flattened());
    let normals = make.floats("VEC3", [[0.0f32, 0.0, 1.0]; N].as_flattened());
    let joints = make.accessor(U8, "VEC4", N, joints.as_flattened());
    let weights = make.floats("VEC4", weights.as_flattened());
    let target = make.floats("VEC3", wide.as_flattened());
    *make.primitive() = json!({"mode": 5, "targets": [{"POSITION": target}], "attributes": {
        "POSITION": positions, "NORMAL": normals, "JOINTS_0": joints, "WEIGHTS_0": weights}});
    make.skin(&[1, 2, 3, 4], &[[0.0; 3], [0.5, 0.0, 0.0], [1.0, 0.0, 0.0], [1.5, 0.0, 0.0]]);
    let step = |child: usize| json!({"translation": [if child > 2 { 0.5 } else { 0.0 }, 0, 0], "children": [child]});
    make.json["nodes"] = json!([{"mesh": 0, "skin": 0}, step(2), step(3), step(4), {"translation": [0.5, 0, 0]}]);
    make.json["scenes"][0]["nodes"] = json!([0, 1]);
    let turn = Quat::from_rotation_z(2.0).to_array();
    for node in 1..5 {
        make.animate(node, "rotation", "LINEAR", &[0.0, 1.0, 2.0], [[0.0, 0.0, 0.0, 1.0], turn, [0.0, 0.0, 0.0, 1.0]].as_flattened());
    }
    make.animate(0, "weights", "LINEAR", &[0.0, 0.7, 2.0], &[0.0, -2.0, 1.5]);
    make.scene()
}

fn contains(outer: Aabb, inner: Aabb) -> bool {
    inner.min.cmpge(outer.min).all() && inner.max.cmple(outer.max).all()
}

#[test]
fn bounds_hold_what_bends_and_are_not_much_larger() {
    let mut scene = curl();
    let whole = scene.bounds();
    let draw = scene.draws[0].clone();
    let parts: Vec<_> = (0..draw.index_count)
        .step_by(90)
        .map(|first| manylight::scene::Draw { first_index: first, index_count: 90.min(draw.index_count - first), ..draw.clone() })
        .collect();
    let reaches: Vec<_> = parts.iter().map(|part| scene.reach(part).unwrap()).collect();
    let mut held = Aabb::EMPTY;
    for step in 0..64 {
        scene.set_time(2.0 * f64::from(step) / 64.0 + 0.011);
        let pose = &scene.bending.as_ref().unwrap().pose;
        for (part, reach) in parts.iter().zip(&reaches) {
            let (found, expected) = (reach.bounds(pose, &part.transform), scene.draw_bounds(part));
            assert!(contains(found, expected), "step {step}: {found:?} does not hold {expected:?}");
            assert!(found.size().length() < 3.0 * expected.size().length() + 0.1, "step {step}: {found:?} for {expected:?}");
        }
        held = held.union(scene.draw_bounds(&draw));
        assert_eq!(scene.bounds(), whole, "the bounds do not jitter");
    }
    assert!(contains(whole, held) && whole.size().length() < 2.0 * held.size().length(), "{whole:?} for {held:?}");
}

#[test]
fn sorted_and_split_triangles_still_bend() {
    let mut scene = Make::stretched().scene();
    scene.split_triangles(0.1);
    scene.sort_triangles();
    assert_eq!(scene.triangle_count(), 2, "what bends is not split");
    scene.set_time(1.0);
    assert!(contains(Aabb { min: Vec3::splat(-1e-4), max: Vec3::new(3.0001, 1.0001, 1e-4) }, scene.draw_bounds(&scene.draws[0])));
    assert!((scene.draw_bounds(&scene.draws[0]).size().x - 3.0).abs() < 1e-4);
}

#[test]
fn a_scene_that_bends_otherwise_is_another_scene() {
    let first = Make::stretched();
    let mut second = Make::stretched();
    second.influences(
        0,
        [[0; 4], [1, 0, 0, 0], [1, 0, 0, 0], [0; 4]],
        [[1.0, 0.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]],
    );
    let mut third = Make::stretched();
    third.target([[0.0, 0.0, 1.0]; 4], None);
    third.animate(0, "weights", "LINEAR", &[0.0, 1.0], &[0.0, 1.0]);
    let digests = [&first, &second, &third].map(|make| scene_digest(&make.scene()));
    assert!(digests[0] != digests[1] && digests[1] != digests[2] && digests[0] != digests[2]);
    // The time that a scene is at is no part of its identity but for what has moved.
    let mut scene = first.scene();
    scene.set_time(1.0);
    scene.set_time(0.0);
    assert_eq!(scene_digest(&scene), digests[0]);
}
