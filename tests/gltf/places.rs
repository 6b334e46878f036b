//! Nodes, scenes, lights, cameras, and files referenced by a file.

use crate::make::{CORNERS, Make, corners, normals, positions, push};
use base64::Engine;
use glam::Vec3;
use manylight::scene::gltf::{self, SceneChoice};
use manylight::scene::{Light, Scene, SpotFalloff};
use serde_json::json;

fn near(a: Vec3, b: Vec3) -> bool {
    a.distance(b) < 1e-5
}

#[test]
fn matrices_and_translation_rotation_scale_stack_up() {
    let mut make = Make::square();
    let quarter = std::f32::consts::FRAC_1_SQRT_2;
    // A rotation by 90 degrees about +Y takes x to -z; the matrix doubles and moves.
    make.json["nodes"] = json!([
        {"children": [1], "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 10, 20, 30, 1]},
        {"children": [2], "rotation": [0, quarter, 0, quarter], "translation": [0, 1, 0]},
        {"mesh": 0, "scale": [1, 3, 1]},
    ]);
    let scene = make.scene();
    let expected = CORNERS.map(|[x, y, _]| Vec3::new(10.0, 20.0 + 2.0 * (3.0 * y + 1.0), 30.0 - 2.0 * x));
    for (read, expected) in positions(&scene, &scene.draws[0]).into_iter().zip([0, 1, 2, 0, 2, 3].map(|i: usize| expected[i])) {
        assert!(near(read, expected), "{read} {expected}");
    }
}

#[test]
fn a_mesh_at_several_nodes_is_there_once_and_drawn_often() {
    let mut make = Make::square();
    make.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0]}]);
    make.json["scenes"][0]["nodes"] = json!([0, 1]);
    let scene = make.scene();
    assert_eq!((scene.vertices.len(), scene.indices.len(), scene.draws.len()), (4, 6, 2));
    assert_eq!(scene.draws[0].first_index, scene.draws[1].first_index);
    assert!(near(positions(&scene, &scene.draws[1])[0], Vec3::new(5.0, 0.0, 0.0)));
}

/// World normals by the winding of the triangles.
fn winding(scene: &Scene, draw: usize) -> Vec<Vec3> {
    let corners = positions(scene, &scene.draws[draw]);
    corners.as_chunks::<3>().0.iter().map(|[a, b, c]| (b - a).cross(c - a).normalize()).collect()
}

#[test]
fn mirrored_nodes_keep_their_front_faces_counter_clockwise() {
    for with_normals in [true, false] {
        let mut make = Make::square();
        make.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "scale": [-1, 1, 1]}, {"mesh": 0, "scale": [-1, 1, -1]}]);
        make.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
        if !with_normals {
            make.primitive()["attributes"].as_object_mut().unwrap().remove("NORMAL");
        }
        let scene = make.scene();
        for (draw, facing) in [(0, Vec3::Z), (1, Vec3::Z), (2, Vec3::NEG_Z)] {
            assert!(winding(&scene, draw).into_iter().all(|n| near(n, facing)), "draw {draw}");
            let transform = scene.draws[draw].transform.matrix3.inverse().transpose();
            assert!(normals(&scene, &scene.draws[draw]).into_iter().all(|n| (transform * n).normalize().distance(facing) < 1e-4));
        }
        assert_eq!(scene.draws[0].first_index, scene.draws[2].first_index);
        if with_normals {
            assert_eq!((scene.vertices.len(), scene.indices.len()), (4, 12));
        }
    }
}

#[test]
fn scenes_are_chosen_by_default_index_or_name_and_listed_where_there_is_none_such() {
    let mut make = Make::square();
    make.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0]}, {"mesh": 0, "translation": [9, 0, 0]}]);
    make.json["scenes"] = json!([{"nodes": [0]}, {"name": "far", "nodes": [1]}, {"nodes": [2, 0]}]);
    make.json["scene"] = json!(2);
    let first = |scene: Scene| positions(&scene, &scene.draws[0])[0].x;
    assert_eq!(first(make.scene()), 9.0);
    assert_eq!(make.scene().draws.len(), 2);
    assert_eq!(first(make.load_scene(SceneChoice::Index(0)).unwrap().scene), 0.0);
    assert_eq!(first(make.load_scene(SceneChoice::Name("far".to_string())).unwrap().scene), 5.0);
    make.json.as_object_mut().unwrap().remove("scene");
    assert_eq!(first(make.scene()), 0.0);
    for (choice, wanted) in [(SceneChoice::Index(3), "3"), (SceneChoice::Name("near".to_string()), "\"near\"")] {
        let message = format!("{:#}", make.load_scene(choice).unwrap_err());
        assert_eq!(message, format!("made.glb: it has no scene {wanted}; there is scene 0, scene 1 (\"far\"), scene 2"));
    }
    // In a file without scenes, every node is shown.
    make.json.as_object_mut().unwrap().remove("scenes");
    make.json["nodes"][0]["children"] = json!([1]);
    assert_eq!(make.scene().draws.len(), 3);
}

#[test]
fn a_node_scaled_to_nothing_hides_all_below_it() {
    let mut make = Make::square();
    make.json["nodes"] = json!([{"mesh": 0}, {"scale": [0, 0, 0], "children": [2], "name": "hidden"}, {"mesh": 0}]);
    make.json["scenes"][0]["nodes"] = json!([0, 1]);
    let loaded = make.load().unwrap();
    assert_eq!(loaded.scene.draws.len(), 1);
    assert!(loaded.warnings[0].contains("hidden"), "{:?}", loaded.warnings);
}

#[test]
fn punctual_lights_shine_along_their_nodes_minus_z() {
    let mut make = Make::square();
    make.json["extensionsUsed"] = json!(["KHR_lights_punctual"]);
    make.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "directional", "color": [1, 0.5, 0.25], "intensity": 8},
        {"type": "point", "intensity": 3},
        {"type": "spot", "intensity": 2, "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}},
        {"type": "spot", "spot": {}},
    ]}});
    // A rotation by -90 degrees about +X takes -z to -y; the scale must not matter.
    let half = std::f32::consts::FRAC_1_SQRT_2;
    for light in 0..4 {
        let node = json!({
            "extensions": {"KHR_lights_punctual": {"light": light}},
            "rotation": [-half, 0, 0, half], "translation": [1, 2, 3], "scale": [2, 2, 2],
        });
        let node = push(&mut make.json["nodes"], node);
        push(&mut make.json["scenes"][0]["nodes"], json!(node));
    }
    let lights = make.scene().lights;
    let (at, down) = (Vec3::new(1.0, 2.0, 3.0), Vec3::NEG_Y);
    assert!(matches!(lights[0], Light::Directional { direction, irradiance }
        if near(direction, down) && irradiance == Vec3::new(8.0, 4.0, 2.0)));
    assert!(matches!(lights[1], Light::Point { position, intensity } if position == at && intensity == Vec3::splat(3.0)));
    assert!(
        matches!(lights[2], Light::Spot { position, direction, intensity, inner: 0.25, outer: 0.5, falloff: SpotFalloff::CosineSquared }
        if position == at && near(direction, down) && intensity == Vec3::splat(2.0))
    );
    assert!(matches!(lights[3], Light::Spot { inner: 0.0, outer: std::f32::consts::FRAC_PI_4, .. }));
}

#[test]
fn perspective_cameras_look_along_minus_z_and_orthographic_ones_are_left_out() {
    let mut make = Make::square();
    make.json["cameras"] = json!([
        {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 10, "znear": 0.1}},
        {"type": "perspective", "perspective": {"yfov": std::f32::consts::FRAC_PI_3, "znear": 0.1}},
    ]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let nodes = json!([
        {"mesh": 0},
        {"camera": 0},
        {"name": "eye", "camera": 1, "translation": [1, 2, 3], "rotation": [0, half, 0, half], "scale": [3, 3, 3]},
    ]);
    make.json["nodes"] = nodes;
    make.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let loaded = make.load().unwrap();
    assert_eq!(loaded.warnings.len(), 1);
    assert!(loaded.warnings[0].contains("orthographic"));
    let [camera] = &loaded.scene.cameras[..] else { panic!("{:?}", loaded.scene.cameras) };
    assert_eq!(camera.name, "eye");
    assert_eq!(camera.position, Vec3::new(1.0, 2.0, 3.0));
    // A rotation by 90 degrees about +Y takes -z to -x.
    assert!(near(camera.target, Vec3::new(0.0, 2.0, 3.0)), "{camera:?}");
    assert!(near(camera.up, Vec3::Y));
    assert!((camera.fov_y_deg - 60.0).abs() < 1e-4);
}

#[test]
fn buffers_and_images_are_found_embedded_and_beside_the_file() {
    let square = Make::square();
    let expected = square.scene();
    let base64 = base64::engine::general_purpose::STANDARD.encode(&square.bin);
    let percent: String = square.bin.iter().map(|byte| format!("%{byte:02X}")).collect();
    for uri in [
        format!("data:application/octet-stream;base64,{base64}"),
        format!("data:application/gltf-buffer;base64,{}", base64.trim_end_matches('=')),
        format!("data:,{percent}"),
    ] {
        let loaded = gltf::load_slice(&square.gltf(&uri), None, "made.gltf", None).unwrap();
        assert_eq!(corners(&loaded.scene, &loaded.scene.draws[0]), corners(&expected, &expected.draws[0]));
    }

    let folder = std::env::temp_dir().join(format!("manylight-gltf-test-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("the parts")).unwrap();
    std::fs::write(folder.join("the parts/büffer #1.bin"), &square.bin).unwrap();
    for uri in ["the%20parts/b%C3%BCffer%20%231.bin", "the parts/büffer #1.bin", "./the%20parts/../the parts/büffer%20#1.bin"] {
        std::fs::write(folder.join("made.gltf"), square.gltf(uri)).unwrap();
        let loaded = gltf::load(&folder.join("made.gltf"), None).unwrap();
        assert_eq!(loaded.scene.name, "made.gltf");
        assert_eq!(corners(&loaded.scene, &loaded.scene.draws[0]), corners(&expected, &expected.draws[0]));
    }
    let missing = square.gltf("the%20parts/none.bin");
    std::fs::write(folder.join("made.gltf"), missing).unwrap();
    let message = format!("{:#}", gltf::load(&folder.join("made.gltf"), None).unwrap_err());
    assert!(message.starts_with(&folder.join("made.gltf").display().to_string()), "{message}");
    assert!(message.contains("buffer 0: the parts/none.bin: cannot be read"), "{message}");

    let folder_as_buffer = square.gltf("the%20parts");
    let message = format!("{:#}", gltf::load_slice(&folder_as_buffer, Some(&folder), "made.gltf", None).unwrap_err());
    assert!(message.contains("the parts: is not a file"), "{message}");
    std::fs::remove_dir_all(&folder).unwrap();
}
