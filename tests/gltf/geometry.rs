//! Primitives and accessors.

use crate::make::{CORNERS, F32, I8, I16, Make, U8, U16, U32, UVS, bytes, corners, normals, positions, push, uvs};
use glam::{Vec2, Vec3};
use manylight::scene::pack;
use serde_json::json;

/// The corners of the square's two triangles.
fn square() -> Vec<Vec3> {
    [0, 1, 2, 0, 2, 3].map(|i: usize| CORNERS[i].into()).to_vec()
}

#[test]
fn indices_of_all_types_give_the_same_triangles() {
    let list = [0u32, 1, 2, 0, 2, 3];
    let wide: Vec<u8> = bytes(&list);
    let medium: Vec<u8> = bytes(&list.map(|i| i as u16));
    let narrow: Vec<u8> = bytes(&list.map(|i| i as u8));
    for (component, data) in [(U8, narrow), (U16, medium), (U32, wide)] {
        let mut make = Make::square();
        let indices = make.accessor(component, "SCALAR", 6, &data);
        make.primitive()["indices"] = json!(indices);
        let scene = make.scene();
        assert_eq!(positions(&scene, &scene.draws[0]), square(), "{component}");
        assert_eq!(scene.vertices.len(), 4);
    }
}

#[test]
fn lists_strips_and_fans_without_indices_keep_their_winding() {
    let [a, b, c, d] = CORNERS;
    for (mode, order, triangles) in [
        (4, vec![a, b, c, a, c, d], vec![[a, b, c], [a, c, d]]),
        (5, vec![a, b, d, c], vec![[a, b, d], [b, c, d]]),
        (6, vec![a, b, c, d], vec![[b, c, a], [c, d, a]]),
        // Left-over corners make no triangle.
        (4, vec![a, b, c, a, c], vec![[a, b, c]]),
    ] {
        let mut make = Make::empty();
        let position = make.floats("VEC3", order.as_flattened());
        *make.primitive() = json!({"attributes": {"POSITION": position}, "mode": mode});
        let scene = make.scene();
        let expected: Vec<Vec3> = triangles.as_flattened().iter().map(|&corner| corner.into()).collect();
        assert_eq!(positions(&scene, &scene.draws[0]), expected, "mode {mode}");
        // Flat normals follow from the winding: all of these face +Z.
        assert!(normals(&scene, &scene.draws[0]).iter().all(|n| n.distance(Vec3::Z) < 1e-4), "mode {mode}");
    }
}

#[test]
fn triangles_that_only_join_strips_are_left_out() {
    let mut make = Make::square();
    let indices = make.accessor(U8, "SCALAR", 6, &[0, 1, 1, 3, 3, 2]);
    make.primitive()["indices"] = json!(indices);
    make.primitive()["mode"] = json!(5);
    assert_eq!(make.load().unwrap_err().root_cause().to_string(), "the scene has no triangles");
    let indices = make.accessor(U8, "SCALAR", 5, &[0, 1, 3, 3, 2]);
    make.primitive()["indices"] = json!(indices);
    assert_eq!(make.scene().triangle_count(), 1);
}

#[test]
fn missing_normals_are_made_flat_with_vertices_of_their_own() {
    let mut make = Make::empty();
    // Two triangles at a right angle with a common edge, and one without area.
    let position = make.floats("VEC3", &[0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1.]);
    let indices = make.accessor(U8, "SCALAR", 9, &[0, 1, 2, 0, 3, 1, 1, 2, 1]);
    *make.primitive() = json!({"attributes": {"POSITION": position}, "indices": indices});
    let scene = make.scene();
    assert_eq!((scene.vertices.len(), scene.triangle_count()), (6, 2));
    let normals = normals(&scene, &scene.draws[0]);
    for (normal, expected) in normals.iter().zip([Vec3::Z, Vec3::Z, Vec3::Z, Vec3::Y, Vec3::Y, Vec3::Y]) {
        assert!(normal.distance(expected) < 1e-4, "{normals:?}");
    }
}

#[test]
fn interleaved_attributes_are_read_with_their_stride() {
    let mut make = Make::square();
    let mixed: Vec<f32> = (0..4).flat_map(|i| [&CORNERS[i][..], &[0.0, 0.0, -1.0], &UVS[i][..]].concat()).collect();
    let view = make.view(&bytes(&mixed));
    make.json["bufferViews"][view]["byteStride"] = json!(32);
    let mut accessor = |offset: usize, kind: &str| {
        push(&mut make.json["accessors"], json!({"bufferView": view, "byteOffset": offset, "componentType": F32, "type": kind, "count": 4}))
    };
    let (position, normal, uv) = (accessor(0, "VEC3"), accessor(12, "VEC3"), accessor(24, "VEC2"));
    make.primitive()["attributes"] = json!({"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv});
    let scene = make.scene();
    let draw = &scene.draws[0];
    assert_eq!(positions(&scene, draw), square());
    assert!(normals(&scene, draw).iter().all(|n| n.distance(Vec3::NEG_Z) < 1e-4));
    assert_eq!(uvs(&scene, draw), [0, 1, 2, 0, 2, 3].map(|i: usize| Vec2::from(UVS[i])));
}

#[test]
fn sparse_accessors_replace_elements_with_and_without_a_buffer_view() {
    for (component, indices) in [(U8, bytes(&[1u8, 3])), (U16, bytes(&[1u16, 3])), (U32, bytes(&[1u32, 3]))] {
        for with_view in [true, false] {
            let mut make = Make::square();
            let (indices, values) = (make.view(&indices), make.view(&bytes(&[9.0f32, 0.0, 0.0, 0.0, 9.0, 0.0])));
            let position = &mut make.json["accessors"][0];
            position["sparse"] = json!({
                "count": 2, "indices": {"bufferView": indices, "componentType": component}, "values": {"bufferView": values}
            });
            if !with_view {
                position.as_object_mut().unwrap().remove("bufferView");
                position["count"] = json!(4);
            }
            let scene = make.scene();
            let kept = if with_view { Vec3::new(1.0, 1.0, 0.0) } else { Vec3::ZERO };
            let expected = [Vec3::ZERO, Vec3::new(9.0, 0.0, 0.0), kept, Vec3::new(0.0, 9.0, 0.0)];
            let read: Vec<Vec3> = scene.vertices.iter().map(|v| v.position.into()).collect();
            assert_eq!(read, expected, "{component} {with_view}");
        }
    }
}

#[test]
fn quantized_and_normalized_attributes_come_back_as_floats() {
    let mut make = Make::square();
    make.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    make.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    // Positions are three 16-bit numbers and normals three bytes, padded to multiples of four.
    let position = make.attribute(
        "POSITION",
        I16,
        "VEC3",
        &bytes([[0i16, 0, 0, 0], [1000, 0, 0, 0], [1000, 2000, 0, 0], [0, -3000, 5, 0]].as_flattened()),
    );
    let normal =
        make.attribute("NORMAL", I8, "VEC3", &bytes([[0i8, 0, 127, 0], [127, 0, 0, 0], [-128, 0, 0, 0], [0, -127, 0, 0]].as_flattened()));
    let uv = make.attribute("TEXCOORD_0", U16, "VEC2", &bytes(&[0u16, 65535, 65535, 65535, 32768, 0, 0, 13107]));
    for (accessor, stride, normalized) in [(position, 8, false), (normal, 4, true), (uv, 4, true)] {
        let view = make.json["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
        make.json["bufferViews"][view]["byteStride"] = json!(stride);
        make.json["accessors"][accessor]["normalized"] = json!(normalized);
    }
    let scene = make.scene();
    let read: Vec<[f32; 3]> = scene.vertices.iter().map(|v| v.position).collect();
    assert_eq!(read, [[0.0; 3], [1000.0, 0.0, 0.0], [1000.0, 2000.0, 0.0], [0.0, -3000.0, 5.0]]);
    for (vertex, normal) in scene.vertices.iter().zip([Vec3::Z, Vec3::X, Vec3::NEG_X, Vec3::NEG_Y]) {
        assert!(pack::octahedral_snorm16_inverse(vertex.normal).distance(normal) < 1e-4);
    }
    let expected = [[0.0, 1.0], [1.0, 1.0], [32768.0 / 65535.0, 0.0], [0.0, 0.2]];
    for (vertex, uv) in scene.vertices.iter().zip(expected) {
        assert!(Vec2::from(vertex.uv).distance(uv.into()) < 1e-6, "{:?}", vertex.uv);
    }
}

#[test]
fn vertex_colours_of_every_layout_become_the_same_bytes() {
    // One row for each corner; with three components the fourth column is left out.
    let colors = [[0u8, 51, 255, 102], [255, 255, 255, 255], [102, 0, 0, 0], [0, 0, 0, 255]];
    for size in [3, 4] {
        let flat: Vec<u8> = colors.iter().flat_map(|c| c[..size].to_vec()).collect();
        let kind = ["VEC3", "VEC4"][size - 3];
        let layouts = [
            (F32, bytes(&flat.iter().map(|&c| f32::from(c) / 255.0).collect::<Vec<_>>())),
            (U8, flat.clone()),
            (U16, bytes(&flat.iter().map(|&c| u16::from(c) * 257).collect::<Vec<_>>())),
        ];
        for (component, data) in layouts {
            let mut make = Make::square();
            let accessor = make.attribute("COLOR_0", component, kind, &data);
            make.json["accessors"][accessor]["normalized"] = json!(component != F32);
            let read: Vec<[u8; 4]> = make.scene().vertices.iter().map(|v| v.color.to_le_bytes()).collect();
            let expected = colors.map(|c| if size == 4 { c } else { [c[0], c[1], c[2], 255] });
            assert_eq!(read, expected, "{kind} of {component}");
        }
    }
    assert!(Make::square().scene().vertices.iter().all(|v| v.color == u32::MAX));
}

#[test]
fn primitives_of_the_same_attributes_share_their_vertices() {
    let mut make = Make::square();
    let half = make.accessor(U8, "SCALAR", 3, &[0, 2, 3]);
    let mut second = make.primitive().clone();
    second["indices"] = json!(half);
    push(&mut make.json["meshes"][0]["primitives"], second);
    let scene = make.scene();
    assert_eq!((scene.vertices.len(), scene.indices.len(), scene.draws.len()), (4, 9, 2));
    assert_eq!(positions(&scene, &scene.draws[1]), [0, 2, 3].map(|i: usize| Vec3::from(CORNERS[i])));
}

#[test]
fn points_and_lines_are_left_out_with_one_warning() {
    let mut make = Make::square();
    for mode in [0, 1, 2, 3] {
        let mut primitive = make.primitive().clone();
        primitive["mode"] = json!(mode);
        push(&mut make.json["meshes"][0]["primitives"], primitive);
    }
    let loaded = make.load().unwrap();
    assert_eq!(loaded.scene.triangle_count(), 2);
    let [points] = &loaded.warnings[..] else { panic!("{:?}", loaded.warnings) };
    assert!(points.contains("points and lines") && points.contains("3 more"));
}

#[test]
fn normals_without_length_are_replaced_and_warned_about() {
    let mut make = Make::square();
    make.attribute("NORMAL", F32, "VEC3", &[0; 48]);
    let loaded = make.load().unwrap();
    assert!(loaded.warnings[0].contains("normals have no length"));
    assert!(corners(&loaded.scene, &loaded.scene.draws[0]).iter().all(|v| pack::octahedral_snorm16_inverse(v.normal).is_normalized()));
}
