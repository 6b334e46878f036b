//! Materials, textures, samplers and tangents.

use crate::make::{F32, I8, Make, UVS, bytes, corners, png, push, uvs};
use glam::{Vec2, Vec3};
use manylight::scene::{Filter, Map, Material, Wrap, pack};
use serde_json::json;

const RED_GREEN: [u8; 8] = [255, 0, 0, 255, 0, 255, 0, 51];

#[test]
fn a_primitive_without_a_material_has_gltfs_default_one() {
    let scene = Make::square().scene();
    // The format's default is a rough metal.
    assert_eq!(scene.materials, [Material { name: "default".to_string(), metallic: 1.0, ..Material::default() }]);
}

#[test]
fn factors_are_read_and_emission_gets_its_strength() {
    let scene = Make::textured(json!({
        "name": "all", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25, "emissiveFactor": [0.5, 1, 0],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 6}},
        "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.75},
    }))
    .scene();
    let expected = Material {
        name: "all".to_string(),
        base_color: [0.1, 0.2, 0.3, 0.4],
        metallic: 0.5,
        roughness: 0.75,
        emission: [3.0, 6.0, 0.0],
        alpha_cutoff: Some(0.25),
        double_sided: true,
        ..Material::default()
    };
    assert_eq!(scene.materials, [expected]);
}

#[test]
fn alpha_modes_become_cutoffs_and_blending_is_warned_about_once() {
    for (mode, cutoff) in [("OPAQUE", None), ("MASK", Some(0.5))] {
        assert_eq!(Make::textured(json!({"alphaMode": mode})).scene().materials[0].alpha_cutoff, cutoff);
    }
    let mut make = Make::textured(json!({"alphaMode": "BLEND", "alphaCutoff": 0.9}));
    push(&mut make.json["materials"], json!({"alphaMode": "BLEND"}));
    let mut second = make.primitive().clone();
    second["material"] = json!(1);
    push(&mut make.json["meshes"][0]["primitives"], second);
    let loaded = make.load().unwrap();
    assert_eq!(loaded.scene.materials.iter().map(|m| m.alpha_cutoff).collect::<Vec<_>>(), [Some(0.5); 2]);
    assert_eq!(loaded.warnings.len(), 1);
    assert!(loaded.warnings[0].contains("blended"));
}

#[test]
fn maps_are_colour_or_data_and_an_image_used_as_both_becomes_two_textures() {
    let mut make = Make::textured(json!({
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0}},
        "emissiveTexture": {"index": 1}, "normalTexture": {"index": 1, "scale": 0.5},
    }));
    make.texture(&png(2, 1, &RED_GREEN));
    make.texture(&png(1, 2, &RED_GREEN));
    let scene = make.scene();
    let material = &scene.materials[0];
    let texture = |map: Option<Map>| &scene.textures[map.unwrap().texture as usize];
    assert_eq!(scene.textures.len(), 4);
    for (map, width, srgb) in [
        (material.base_color_map, 2, true),
        (material.metallic_roughness_map, 2, false),
        (material.emission_map, 1, true),
        (material.normal_map, 1, false),
    ] {
        let texture = texture(map);
        assert_eq!((texture.width, texture.height, texture.srgb), (width, 3 - width, srgb));
        assert_eq!(texture.texels, RED_GREEN);
    }
    assert_eq!(material.normal_scale, 0.5);
}

#[test]
fn only_what_is_used_is_read() {
    let mut make = Make::textured(json!({}));
    make.texture(b"no image at all");
    push(&mut make.json["materials"], json!({"emissiveTexture": {"index": 0}}));
    push(&mut make.json["meshes"], json!({"primitives": [{"attributes": {"POSITION": 99}}]}));
    let scene = make.scene();
    assert_eq!((scene.materials.len(), scene.textures.len()), (1, 0));
}

#[test]
fn images_of_other_depths_and_jpegs_decode_to_eight_bits() {
    let mut gray = std::io::Cursor::new(Vec::new());
    let ramp = image::ImageBuffer::<image::Luma<u16>, _>::from_raw(2, 1, vec![0u16, 65535]).unwrap();
    ramp.write_to(&mut gray, image::ImageFormat::Png).unwrap();
    let mut jpeg = std::io::Cursor::new(Vec::new());
    image::RgbImage::from_pixel(16, 8, image::Rgb([200, 100, 50])).write_to(&mut jpeg, image::ImageFormat::Jpeg).unwrap();
    let mut make = Make::textured(json!({"emissiveTexture": {"index": 0}, "pbrMetallicRoughness": {"baseColorTexture": {"index": 1}}}));
    make.texture(&gray.into_inner());
    make.texture(&jpeg.into_inner());
    let scene = make.scene();
    let [color, gray] = &scene.textures[..] else { panic!("{} textures", scene.textures.len()) };
    assert_eq!(gray.texels, [0, 0, 0, 255, 255, 255, 255, 255]);
    assert_eq!((color.width, color.height), (16, 8));
    for texel in color.texels.as_chunks::<4>().0 {
        assert!(texel.iter().zip([200u8, 100, 50, 255]).all(|(a, b)| a.abs_diff(b) < 4), "{texel:?}");
    }
}

#[test]
fn samplers_give_wrapping_and_filter() {
    for (sampler, expected) in [
        (json!({}), (Wrap::Repeat, Wrap::Repeat, Filter::Linear)),
        (
            json!({"wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9987}),
            (Wrap::ClampToEdge, Wrap::MirroredRepeat, Filter::Nearest),
        ),
        (json!({"wrapS": 10497, "magFilter": 9729, "minFilter": 9728}), (Wrap::Repeat, Wrap::Repeat, Filter::Linear)),
        (json!({"minFilter": 9984}), (Wrap::Repeat, Wrap::Repeat, Filter::Nearest)),
    ] {
        let mut make = Make::textured(json!({"emissiveTexture": {"index": 0}}));
        make.texture(&png(2, 1, &RED_GREEN));
        make.json["samplers"] = json!([sampler]);
        make.json["textures"][0]["sampler"] = json!(0);
        let map = make.scene().materials[0].emission_map.unwrap();
        assert_eq!((map.wrap_u, map.wrap_v, map.filter), expected, "{sampler}");
    }
}

#[test]
fn texture_transforms_scale_then_turn_then_move() {
    // The extension's own example: the lower left quarter of the image, turned clockwise by 90 degrees.
    let transform = json!({"KHR_texture_transform": {"offset": [0, 1], "rotation": std::f32::consts::FRAC_PI_2, "scale": [0.5, 0.5]}});
    let reference = json!({"index": 0, "extensions": transform});
    let mut make = Make::textured(json!({
        "emissiveTexture": reference, "normalTexture": reference, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}
    }));
    make.texture(&png(2, 1, &RED_GREEN));
    make.json["extensionsRequired"] = json!(["KHR_texture_transform"]);
    let scene = make.scene();
    let material = &scene.materials[0];
    for map in [material.emission_map, material.normal_map].map(Option::unwrap) {
        let at = |u, v| map.matrix * Vec2::new(u, v) + map.offset;
        for (from, to) in [((0., 0.), (0., 1.)), ((1., 0.), (0., 0.5)), ((0., 1.), (0.5, 1.)), ((1., 1.), (0.5, 0.5))] {
            assert!(at(from.0, from.1).distance(Vec2::new(to.0, to.1)) < 1e-6, "{from:?} to {}", at(from.0, from.1));
        }
    }
    assert_eq!(material.base_color_map, Some(Map::new(0)));
}

#[test]
fn the_base_colours_set_of_texture_coordinates_is_the_one_and_mixing_sets_is_warned_about() {
    let other = UVS.map(|[u, v]| [u + 5.0, v]);
    let mut make = Make::textured(json!({
        "emissiveTexture": {"index": 0},
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"texCoord": 1}}}},
    }));
    make.texture(&png(2, 1, &RED_GREEN));
    make.attribute("TEXCOORD_1", F32, "VEC2", &bytes(other.as_flattened()));
    let loaded = make.load().unwrap();
    assert_eq!(uvs(&loaded.scene, &loaded.scene.draws[0])[0], Vec2::new(5.0, 1.0));
    assert_eq!(loaded.warnings.len(), 1);
    assert!(loaded.warnings[0].contains("mixes sets"), "{:?}", loaded.warnings);

    make.json["materials"][0]["emissiveTexture"]["texCoord"] = json!(1);
    assert_eq!(uvs(&make.scene(), &make.scene().draws[0])[0], Vec2::new(5.0, 1.0));
    // Without a base colour texture, the first existing texture sets it.
    make.json["materials"][0]["pbrMetallicRoughness"] = json!({});
    assert_eq!(uvs(&make.scene(), &make.scene().draws[0])[0], Vec2::new(5.0, 1.0));

    make.primitive()["attributes"].as_object_mut().unwrap().remove("TEXCOORD_1");
    let loaded = make.load().unwrap();
    assert!(loaded.warnings[0].contains("TEXCOORD_1"), "{:?}", loaded.warnings);
    assert_eq!(uvs(&loaded.scene, &loaded.scene.draws[0])[0], Vec2::ZERO);
}

#[test]
fn given_tangents_are_kept_and_missing_ones_are_made() {
    let mut make = Make::textured(json!({"normalTexture": {"index": 0}}));
    make.texture(&png(1, 1, &[128, 128, 255, 255]));
    let tangents = |make: &Make| {
        let scene = make.scene();
        scene.draws.iter().map(|draw| corners(&scene, draw).iter().map(|v| v.tangent).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    assert_eq!(tangents(&make), [vec![pack::tangent(Vec3::X, 1.0); 6]]);

    // Mirroring flips the handedness.
    make.json["nodes"] = json!([{"mesh": 0}, {"mesh": 0, "scale": [-1, 1, 1]}]);
    make.json["scenes"][0]["nodes"] = json!([0, 1]);
    let both = |handedness| [vec![pack::tangent(Vec3::X, handedness); 6], vec![pack::tangent(Vec3::X, -handedness); 6]];
    assert_eq!(tangents(&make), both(1.0));

    make.attribute("TANGENT", F32, "VEC4", &bytes([[2.0f32, 0.0, 0.0, -1.0]; 4].as_flattened()));
    assert_eq!(tangents(&make), both(-1.0));
    make.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    let quantized = make.attribute("TANGENT", I8, "VEC4", &bytes([[127i8, 0, 0, -127]; 4].as_flattened()));
    make.json["accessors"][quantized]["normalized"] = json!(true);
    assert_eq!(tangents(&make), both(-1.0));

    // Without normals, flat ones are made, and the file's tangents are meaningless.
    make.primitive()["attributes"].as_object_mut().unwrap().remove("NORMAL");
    assert_eq!(tangents(&make), both(1.0));
}

#[test]
fn an_extension_that_is_only_used_is_warned_about() {
    let mut make = Make::square();
    make.json["extensionsUsed"] = json!(["KHR_texture_transform", "EXT_one", "KHR_two", "EXT_one"]);
    let warnings = make.load().unwrap().warnings;
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].ends_with("EXT_one, KHR_two"), "{warnings:?}");
}
