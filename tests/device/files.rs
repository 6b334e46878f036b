//! glTF files as drawn by the device, tested at a few pixels.

use crate::common::*;
use crate::make::{F32, Make, bytes as bytes_of, png, push};
use glam::{Vec3, vec3};
use manylight::output::Picture;
use manylight::scene::Scene;
use serde_json::{Value, json};

/// Half the picture's width in the plane z = 0, m, and its centre.
const HALF: f32 = 3.0;
const MIDDLE: Vec3 = Vec3::new(0.5, 1.0, 0.0);
const SIZE: u32 = 96;

/// A picture of the plane z = 0, seen from its front.
fn draw(scene: Scene) -> Picture {
    let mut renderer = renderer(scene);
    let eye = MIDDLE + Vec3::Z * HALF;
    let config = plain([SIZE, SIZE], eye, MIDDLE, 90.0, directional(Vec3::NEG_Z, [1.0; 3]));
    let picture = picture(&mut renderer, &config);
    finish(renderer.gpu());
    picture
}

/// Position, normal and albedo at a point of the plane; `None` without a surface.
fn at(picture: &Picture, x: f32, y: f32) -> Option<(Vec3, Vec3, Vec3)> {
    let pixel = |offset: f32| ((offset / HALF * 0.5 + 0.5) * SIZE as f32) as u32;
    let i = (pixel(MIDDLE.y - y) * SIZE + pixel(x - MIDDLE.x)) as usize;
    let [r, g, b, _] = picture.albedo.at(i);
    (picture.depth.values[i] > 0.0).then(|| (picture.positions()[i], picture.normals()[i], Vec3::new(r, g, b)))
}

#[track_caller]
fn near(found: Vec3, expected: Vec3, tolerance: f32) {
    assert!(found.distance(expected) < tolerance, "{found} instead of {expected}");
}

/// An image of one texel.
fn plain_image(rgba: [u8; 4]) -> Vec<u8> {
    png(1, 1, &rgba)
}

/// A square with a normal map of one tilt, given by bytes; the node is drawn as it is and mirrored at x = 0.
fn tilted(bytes: [u8; 3], given_tangents: bool) -> Picture {
    let [r, g, b] = bytes;
    let mut make = Make::textured(json!({"normalTexture": {"index": 0}}));
    if given_tangents {
        make.attribute("TANGENT", F32, "VEC4", &bytes_of([[1.0f32, 0.0, 0.0, 1.0]; 4].as_flattened()));
    }
    make.texture(&plain_image([r, g, b, 255]));
    make.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "scale": [-1.0, 1.0, 1.0]}]);
    make.json["scenes"][0]["nodes"] = json!([0, 1]);
    draw(make.scene())
}

#[test]
fn a_normal_map_tilts_normals_along_the_image_and_a_mirrored_instance_mirrors_them() {
    let byte = |byte: u8| f32::from(byte) / 255.0 * 2.0 - 1.0;
    // Red points to the image's right, which is left on a mirrored instance; green points up on both.
    for given_tangents in [false, true] {
        for bytes in [[204, 128, 230], [128, 204, 230]] {
            let picture = tilted(bytes, given_tangents);
            let expected = Vec3::from(bytes.map(byte)).normalize();
            near(at(&picture, 0.5, 0.5).unwrap().1, expected, 2e-3);
            near(at(&picture, -0.5, 0.5).unwrap().1, expected * vec3(-1.0, 1.0, 1.0), 2e-3);
        }
    }
}

#[test]
fn a_masked_square_has_holes_where_its_image_is_clear() {
    let nearest = json!([{"magFilter": 9728, "minFilter": 9728}]);
    for (mode, covered) in [("MASK", false), ("OPAQUE", true)] {
        let mut make = Make::textured(json!({
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "alphaMode": mode, "alphaCutoff": 0.5,
        }));
        make.texture(&png(2, 1, &[255, 255, 255, 255, 255, 255, 255, 100]));
        make.json["samplers"] = nearest.clone();
        make.json["textures"][0]["sampler"] = json!(0);
        if mode == "OPAQUE" {
            make.json["materials"][0].as_object_mut().unwrap().remove("alphaCutoff");
        }
        let picture = draw(make.scene());
        for x in [0.1, 0.25, 0.4] {
            near(at(&picture, x, 0.5).unwrap().2, Vec3::ONE, 1e-3);
            assert_eq!(at(&picture, x + 0.5, 0.5).is_some(), covered, "{mode} at {}", x + 0.5);
        }
    }
}

#[test]
fn textures_of_several_sizes_each_reach_their_own_surface() {
    let textured = |index: usize| json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": index}}});
    let mut make = Make::textured(textured(0));
    let sizes = [(4u32, 4u32), (16, 8), (4, 4), (1, 1)];
    let colors = [[255u8, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [188, 188, 0, 255]];
    for ((width, height), color) in sizes.into_iter().zip(colors) {
        make.texture(&png(width, height, &color.repeat((width * height) as usize)));
    }
    make.json["materials"] = json!((0..4).map(textured).collect::<Vec<_>>());
    let first = make.json["meshes"][0].clone();
    for material in 1..4 {
        let mut mesh: Value = first.clone();
        mesh["primitives"][0]["material"] = json!(material);
        push(&mut make.json["meshes"], mesh);
    }
    make.json["nodes"] = json!((0..4).map(|i| json!({"mesh": i, "translation": [i as f32 - 1.5, 0.0, 0.0]})).collect::<Vec<_>>());
    make.json["scenes"][0]["nodes"] = json!([0, 1, 2, 3]);
    let picture = draw(make.scene());
    let linear = ((188.0f32 / 255.0 + 0.055) / 1.055).powf(2.4);
    for (i, expected) in [Vec3::X, Vec3::Y, Vec3::Z, vec3(linear, linear, 0.0)].into_iter().enumerate() {
        near(at(&picture, i as f32 - 1.0, 0.5).unwrap().2, expected, 2e-3);
    }
}

#[test]
fn nested_nodes_carry_a_square_and_its_image_to_its_place() {
    let mut make = Make::textured(json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}));
    make.texture(&png(2, 1, &[255, 0, 0, 255, 0, 255, 0, 255]));
    make.json["samplers"] = json!([{"magFilter": 9728, "minFilter": 9728}]);
    make.json["textures"][0]["sampler"] = json!(0);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    // A quarter turn about Z and a step to the right around a stretched square: (x, y) goes to (1 - y, 2 x + 1).
    make.json["nodes"] = json!([
        {"translation": [1.0, 0.0, 0.0], "rotation": [0.0, 0.0, half, half], "children": [1]},
        {"translation": [1.0, 0.0, 0.0], "scale": [2.0, 1.0, 1.0], "mesh": 0},
    ]);
    let picture = draw(make.scene());
    for (x, y, expected) in [(0.2, 1.2, Vec3::X), (0.8, 1.8, Vec3::X), (0.2, 2.2, Vec3::Y), (0.8, 2.8, Vec3::Y)] {
        let (position, normal, albedo) = at(&picture, x, y).unwrap();
        near(position, vec3(x, y, 0.0), HALF / SIZE as f32 * 1.5);
        assert!(position.z.abs() < 1e-4);
        near(normal, Vec3::Z, 1e-4);
        near(albedo, expected, 1e-3);
    }
    for (x, y) in [(-0.2, 2.0), (1.2, 2.0), (0.5, 0.8), (0.5, 3.2)] {
        assert!(at(&picture, x, y).is_none(), "({x}, {y}) is beside the square");
    }
}

#[test]
fn the_back_of_a_square_is_seen_only_where_it_is_double_sided() {
    for double_sided in [false, true] {
        for mirrored in [false, true] {
            let mut make = Make::textured(json!({"doubleSided": double_sided}));
            // A half turn about Y shows the back; mirroring on top of it changes nothing.
            make.json["nodes"][0]["rotation"] = json!([0.0, 1.0, 0.0, 0.0]);
            make.json["nodes"][0]["scale"] = json!([if mirrored { -1.0 } else { 1.0 }, 1.0, 1.0]);
            let picture = draw(make.scene());
            let seen = at(&picture, if mirrored { 0.5 } else { -0.5 }, 0.5);
            assert_eq!(seen.is_some(), double_sided, "mirrored: {mirrored}");
            if let Some((_, normal, _)) = seen {
                near(normal, Vec3::Z, 1e-4);
            }
        }
    }
}
