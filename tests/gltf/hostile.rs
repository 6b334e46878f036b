//! Damaged and lying files: each is refused in one sentence that names the fault, quickly and with little memory.

use crate::make::{F32, Make, U8, U16, bytes, glb, png, push};
use manylight::error::{Exit, exit_code};
use manylight::scene::gltf;
use serde_json::{Value, json};

/// Name, change to the textured square, and expected part of the message.
pub type Case = (&'static str, fn(&mut Make), &'static str);

fn position(make: &mut Make) -> &mut Value {
    &mut make.json["accessors"][0]
}

/// Replaces the textured square's only texture by this image.
fn image(make: &mut Make, encoded: &[u8]) {
    make.texture(encoded);
    make.json["materials"][0] = json!({"emissiveTexture": {"index": 0}});
}

fn light(make: &mut Make, light: Value) {
    make.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [light]}});
    make.node()["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
}

/// A PNG whose header claims another size, with a correct checksum.
fn png_of(width: u32, height: u32) -> Vec<u8> {
    let mut file = png(1, 1, &[0; 4]);
    file[16..20].copy_from_slice(&width.to_be_bytes());
    file[20..24].copy_from_slice(&height.to_be_bytes());
    let crc = file[12..29].iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
    });
    file[29..33].copy_from_slice(&(!crc).to_be_bytes());
    file
}

const CASES: &[Case] = &[
    ("another version", |m| m.json["asset"]["version"] = json!("1.0"), "it needs glTF 1.0"),
    ("a later version", |m| m.json["asset"]["minVersion"] = json!("2.1"), "it needs glTF 2.1"),
    ("no asset", |m| drop(m.json.as_object_mut().unwrap().remove("asset")), "missing field `asset`"),
    ("JSON of another shape", |m| m.json["nodes"] = json!(5), "its JSON is not that of a glTF 2.0 file"),
    (
        "a required extension",
        |m| m.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression", "KHR_texture_transform"]),
        "it requires the extension KHR_draco_mesh_compression, which is not supported",
    ),
    // Nodes.
    ("a scene that is not there", |m| m.json["scene"] = json!(7), "scene 7 does not exist, the file has 1"),
    ("a root that is not there", |m| m.json["scenes"][0]["nodes"] = json!([4]), "node 4 does not exist, the file has 1"),
    ("a child that is not there", |m| m.node()["children"] = json!([4]), "node 4 does not exist"),
    ("a mesh that is not there", |m| m.node()["mesh"] = json!(1), "node 0: mesh 1 does not exist, the file has 1"),
    ("a node that is its own child", |m| m.node()["children"] = json!([0]), "node 0 is reached twice"),
    (
        "a longer cycle",
        |m| m.json["nodes"] = json!([{"mesh": 0, "children": [1]}, {"children": [2]}, {"name": "back", "children": [0]}]),
        "node 0 is reached twice: nodes must form trees, without cycles",
    ),
    (
        "a node with two parents",
        |m| m.json["nodes"] = json!([{"children": [1, 2]}, {"children": [3]}, {"children": [3]}, {"mesh": 0}]),
        "node 3 is reached twice",
    ),
    ("no triangles", |m| m.json["nodes"] = json!([{}]), "the scene has no triangles"),
    ("no nodes", |m| m.json["scenes"][0]["nodes"] = json!([]), "the scene has no triangles"),
    ("a flat transform", |m| m.node()["scale"] = json!([1, 1, 0]), "node 0: its transform (with its parents') is singular"),
    ("a matrix of dependent columns", |m| m.node()["matrix"] = json!([1, 2, 3, 0, 2, 4, 6, 0, 0, 0, 1, 0, 0, 0, 0, 1]), "singular"),
    ("a projective matrix", |m| m.node()["matrix"] = json!([1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]), "last row"),
    ("a number past what is finite", |m| m.node()["translation"] = json!([1e39, 0, 0]), "its transform is not finite"),
    ("a rotation by nothing", |m| m.node()["rotation"] = json!([0, 0, 0, 0]), "not a unit quaternion"),
    ("a place too far away", |m| m.node()["translation"] = json!([0, 0, 1e12]), "farther than"),
    // Buffers and views.
    ("a buffer shorter than it says", |m| m.json["buffers"] = json!([{"byteLength": 9999}]), "buffer 0: it says 9999 bytes, but has"),
    ("a huge buffer", |m| m.json["buffers"] = json!([{"byteLength": 1u64 << 62}]), "more than the"),
    ("a second binary chunk", |m| m.json["buffers"] = json!([{"byteLength": 4}, {"byteLength": 4}]), "buffer 1: it has no uri"),
    ("a buffer from the network", |m| m.json["buffers"] = json!([{"byteLength": 4, "uri": "https://x.org/a"}]), "scheme \"https\""),
    ("a buffer of another scheme", |m| m.json["buffers"] = json!([{"byteLength": 4, "uri": "file:///etc/passwd"}]), "scheme \"file\""),
    ("a buffer beside no file", |m| m.json["buffers"] = json!([{"byteLength": 4, "uri": "a.bin"}]), "no folder to look for it"),
    ("a data: uri without contents", |m| m.json["buffers"] = json!([{"byteLength": 4, "uri": "data:base64"}]), "no comma"),
    ("bad base64", |m| m.json["buffers"] = json!([{"byteLength": 4, "uri": "data:;base64,A@=="}]), "not base64"),
    ("a uri that is no text", |m| m.json["buffers"] = json!([{"byteLength": 4, "uri": "%ff%fe"}]), "not UTF-8"),
    ("a view of no buffer", |m| m.json["bufferViews"][0]["buffer"] = json!(3), "buffer view 0: buffer 3 does not exist, the file has 1"),
    ("a view past the end", |m| m.json["bufferViews"][0]["byteLength"] = json!(10_000), "past the end of buffer 0"),
    ("a view whose end overflows", |m| m.json["bufferViews"][0]["byteOffset"] = json!(u64::MAX), "past the end of buffer 0"),
    ("a stride that is too small", |m| m.json["bufferViews"][0]["byteStride"] = json!(4), "byteStride of 4 is less than an element's 12"),
    ("a stride of zero", |m| m.json["bufferViews"][0]["byteStride"] = json!(0), "byteStride of 0, it must be from 4 to 252"),
    ("a stride that is too large", |m| m.json["bufferViews"][0]["byteStride"] = json!(1u64 << 40), "it must be from 4 to 252"),
    ("a stride past the end", |m| m.json["bufferViews"][0]["byteStride"] = json!(252), "4 elements from byte 0 on go past its 48 bytes"),
    // Accessors.
    ("no POSITION", |m| m.primitive()["attributes"] = json!({}), "mesh 0: primitive 0: it has no POSITION"),
    ("an accessor that is not there", |m| m.primitive()["attributes"]["POSITION"] = json!(50), "accessor 50 does not exist"),
    ("a view that is not there", |m| position(m)["bufferView"] = json!(50), "POSITION, accessor 0: buffer view 50 does not exist"),
    ("a huge count", |m| position(m)["count"] = json!(4_000_000_000u64), "4000000000 elements from byte 0 on go past its 48 bytes"),
    ("a count that overflows", |m| position(m)["count"] = json!(u64::MAX), "go past its 48 bytes"),
    ("a count below zero", |m| position(m)["count"] = json!(-1), "its JSON is not that of a glTF 2.0 file"),
    ("an offset that overflows", |m| position(m)["byteOffset"] = json!(u64::MAX), "go past its 48 bytes"),
    (
        "many zeros",
        |m| drop((position(m).as_object_mut().unwrap().remove("bufferView"), position(m)["count"] = json!(1u64 << 40))),
        "but no buffer view",
    ),
    ("a component type of no one", |m| position(m)["componentType"] = json!(5124), "its componentType is none of glTF's"),
    ("a type of no one", |m| position(m)["type"] = json!("VEC5"), "its type is none of glTF's"),
    ("positions of two numbers", |m| position(m)["type"] = json!("VEC2"), "its type is Vec2, which POSITION cannot be"),
    (
        "a matrix as colour",
        |m| {
            let a = m.attribute("COLOR_0", F32, "VEC4", &[0; 64]);
            m.json["accessors"][a]["type"] = json!("MAT2")
        },
        "its type is Mat2",
    ),
    ("integers without the extension", |m| position(m)["componentType"] = json!(U8), "its components are U8, which POSITION cannot be"),
    (
        "colours that are not normalized",
        |m| {
            m.attribute("COLOR_0", U8, "VEC4", &[0; 16]);
        },
        "its components are U8, which COLOR_0 cannot be",
    ),
    (
        "floats as indices",
        |m| {
            let a = m.floats("SCALAR", &[0.0; 6]);
            m.primitive()["indices"] = json!(a)
        },
        "its components are F32, indices are",
    ),
    ("vectors as indices", |m| m.primitive()["indices"] = json!(0), "indices are scalars"),
    (
        "indices past the vertices",
        |m| {
            let a = m.accessor(U8, "SCALAR", 3, &[0, 1, 4]);
            m.primitive()["indices"] = json!(a)
        },
        "name vertex 4, it has 4",
    ),
    (
        "the restart index",
        |m| {
            let a = m.accessor(U16, "SCALAR", 3, &[0, 0, 1, 0, 255, 255]);
            m.primitive()["indices"] = json!(a)
        },
        "name vertex 65535, it has 4",
    ),
    ("attributes of other lengths", |m| m.json["accessors"][1]["count"] = json!(3), "its NORMAL has 3 elements, its POSITION 4"),
    (
        "positions that are not numbers",
        |m| {
            m.attribute("POSITION", F32, "VEC3", &bytes(&[f32::NAN; 12]));
        },
        "element 0 is not finite",
    ),
    (
        "infinite positions",
        |m| {
            let mut p = [0.0; 12];
            p[10] = f32::NEG_INFINITY;
            m.attribute("POSITION", F32, "VEC3", &bytes(&p));
        },
        "element 3 is not finite",
    ),
    (
        "positions too far away",
        |m| {
            m.attribute("POSITION", F32, "VEC3", &bytes(&[3e38f32; 12]));
        },
        "farther than",
    ),
    (
        "a sparse index past the end",
        |m| {
            let v = m.view(&[9; 12]);
            position(m)["sparse"] = json!({"count": 1, "indices": {"bufferView": v, "componentType": U8}, "values": {"bufferView": v}})
        },
        "sparse index 9 is past its 4 elements",
    ),
    (
        "a huge sparse count",
        |m| {
            position(m)["sparse"] =
                json!({"count": 1u64 << 40, "indices": {"bufferView": 0, "componentType": U8}, "values": {"bufferView": 0}})
        },
        "1099511627776 elements from byte 0 on go past",
    ),
    (
        "sparse indices of floats",
        |m| position(m)["sparse"] = json!({"count": 1, "indices": {"bufferView": 0, "componentType": F32}, "values": {"bufferView": 0}}),
        "sparse indices",
    ),
    ("a mode of no one", |m| m.primitive()["mode"] = json!(9), "its mode is none of glTF's"),
    // Materials and images.
    ("a material that is not there", |m| m.primitive()["material"] = json!(6), "mesh 0: material 6 does not exist"),
    (
        "a texture that is not there",
        |m| m.json["materials"][0]["emissiveTexture"] = json!({"index": 3}),
        "material 0: emissiveTexture: texture 3 does not exist",
    ),
    ("an alpha mode of no one", |m| m.json["materials"][0]["alphaMode"] = json!("HALF"), "its alphaMode is none of"),
    (
        "an infinite factor",
        |m| m.json["materials"][0]["pbrMetallicRoughness"] = json!({"roughnessFactor": 1e300}),
        "its roughnessFactor is not finite",
    ),
    ("an infinite emission", |m| m.json["materials"][0]["emissiveFactor"] = json!([1e300, 0, 0]), "emissiveFactor"),
    (
        "a texture of another format only",
        |m| {
            image(m, &png(1, 1, &[0; 4]));
            m.json["textures"][0] = json!({})
        },
        "texture 0 has no PNG or JPEG as its source",
    ),
    (
        "an image that is not there",
        |m| {
            image(m, &png(1, 1, &[0; 4]));
            m.json["textures"][0]["source"] = json!(8)
        },
        "image 8 does not exist",
    ),
    (
        "a sampler that is not there",
        |m| {
            image(m, &png(1, 1, &[0; 4]));
            m.json["textures"][0]["sampler"] = json!(8)
        },
        "sampler 8 does not exist",
    ),
    (
        "a wrap mode of no one",
        |m| {
            image(m, &png(1, 1, &[0; 4]));
            m.json["textures"][0]["sampler"] = json!(0);
            m.json["samplers"] = json!([{"wrapS": 1}])
        },
        "wrapS or wrapT",
    ),
    (
        "a transform of another shape",
        |m| {
            image(m, &png(1, 1, &[0; 4]));
            m.json["materials"][0] = json!({"normalTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"scale": 5}}}})
        },
        "KHR_texture_transform of its normalTexture",
    ),
    (
        "an image from nowhere",
        |m| {
            image(m, &png(1, 1, &[0; 4]));
            m.json["images"][0] = json!({})
        },
        "image 0: it has neither a bufferView nor a uri",
    ),
    (
        "an image of the network",
        |m| {
            image(m, &png(1, 1, &[0; 4]));
            m.json["images"][0] = json!({"uri": "http://x.org/a.png"})
        },
        "scheme \"http\"",
    ),
    ("text as an image", |m| image(m, b"GIF89a...."), "image 0: it is neither a PNG nor a JPEG"),
    ("no bytes as an image", |m| image(m, b""), "it is neither a PNG nor a JPEG"),
    ("a PNG cut short", |m| image(m, &png(9, 9, &[7; 324])[..60]), "image 0: it does not decode"),
    ("a JPEG cut short", |m| image(m, b"\xff\xd8\xff\xe0"), "image 0: it does not decode"),
    ("an image of no size", |m| image(m, &png_of(0, 1)), "image 0"),
    ("an image too wide", |m| image(m, &png_of(20_000, 1)), "from 1 to 16384 a side are supported"),
    ("an image that cannot be in its bytes", |m| image(m, &png_of(16_000, 16_000)), "which cannot come out of its"),
    // Lights and cameras.
    (
        "a light that is not there",
        |m| m.node()["extensions"] = json!({"KHR_lights_punctual": {"light": 2}}),
        "light 2 does not exist, the file has 0",
    ),
    ("a light of no kind", |m| light(m, json!({"type": "area"})), "its type is none of directional, point and spot"),
    ("a light below zero", |m| light(m, json!({"type": "point", "intensity": -1})), "negative or not finite"),
    ("a spot without its cone", |m| light(m, json!({"type": "spot"})), "does not have the object \"spot\""),
    (
        "a spot inside out",
        |m| light(m, json!({"type": "spot", "spot": {"innerConeAngle": 0.5, "outerConeAngle": 0.4}})),
        "0 <= inner < outer",
    ),
    ("a camera that is not there", |m| m.node()["camera"] = json!(0), "camera 0 does not exist"),
    (
        "a camera of no kind",
        |m| {
            m.node()["camera"] = json!(0);
            m.json["cameras"] = json!([{"type": "perspective"}])
        },
        "camera 0 is neither",
    ),
    (
        "a camera that sees all",
        |m| {
            m.node()["camera"] = json!(0);
            m.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 4, "znear": 1}}])
        },
        "between 0 and pi",
    ),
];

pub fn check(name: &str, bytes: &[u8], expected: &str) {
    let error = gltf::load_slice(bytes, None, "made.glb", None).err().unwrap_or_else(|| panic!("{name}: it is accepted"));
    let message = format!("{error:#}");
    assert!(message.starts_with("made.glb: ") && message.contains(expected), "{name}: {message}");
    assert!(!message.contains('\n'), "{name}: more than one sentence: {message}");
    assert_eq!(exit_code(&error), Exit::BadInput, "{name}");
}

#[test]
fn every_lie_in_the_json_is_named() {
    for (name, bend, expected) in CASES {
        let mut make = Make::textured(json!({}));
        bend(&mut make);
        check(name, &make.glb(), expected);
    }
}

#[test]
fn a_damaged_container_is_named() {
    let whole = Make::square().glb();
    let with = |at: usize, value: u32| {
        let mut bytes = whole.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    let json_length = u32::from_le_bytes(*whole[12..].first_chunk().unwrap());
    let bin = 20 + json_length as usize;
    for (name, bytes, expected) in [
        ("nothing", Vec::new(), "it begins neither as a .glb nor as JSON"),
        ("something else", b"\x7fELF".to_vec(), "it begins neither as a .glb nor as JSON"),
        ("half a header", whole[..8].to_vec(), "ends within the header"),
        ("a cut file", whole[..whole.len() - 5].to_vec(), "it is truncated or damaged"),
        ("another version", with(4, 1), "version 1, only version 2"),
        ("a length within the header", with(8, 4), "it is truncated or damaged"),
        ("a length of the header alone", with(8, 12), "without a JSON chunk"),
        ("a JSON chunk too long", with(12, 0xffff_fff0), "its chunk \"JSON\" says 4294967280 bytes, but only"),
        ("a BIN chunk too long", with(bin, json_length + 1), "its chunk \"BIN\\0\" says"),
        ("a JSON chunk of another kind", with(16, 0x1234_5678), "without a JSON chunk"),
        ("a BIN chunk of another kind", with(bin + 4, 0x1234_5678), "buffer 0: it has no uri"),
        ("JSON cut short", glb(b"{\"asset\":", &[]), "its JSON is not that of a glTF 2.0 file"),
        ("JSON nested deeply", [&b"{\"extensions\":{\"a\":"[..], &[b'['; 100_000]].concat(), "recursion limit"),
        ("bytes that are no text", b"{\"\xff\xfe\":1}".to_vec(), "its JSON is not that of a glTF 2.0 file"),
    ] {
        check(name, &bytes, expected);
    }
}

#[test]
fn no_byte_that_is_cut_or_flipped_makes_it_panic() {
    let mut make = Make::textured(json!({"normalTexture": {"index": 0}}));
    make.texture(&png(2, 2, &[100; 16]));
    make.animate(0, "rotation", "CUBICSPLINE", &[0.0, 1.0], &[0.5; 24]);
    make.animate(0, "scale", "LINEAR", &[0.5, 1.0], &[1., 2., 1., 2., 1., 2.]);
    let whole = make.glb();
    for length in 0..whole.len() {
        drop(gltf::load_slice(&whole[..length], None, "made.glb", None));
    }
    flip_bytes(&whole);
}

/// Loads a file with each of its bytes changed. Neither that nor setting the time of an accepted scene may panic.
pub fn flip_bytes(whole: &[u8]) {
    for at in 0..whole.len() {
        for mask in [0x01, 0x80, 0xff] {
            let mut bent = whole.to_vec();
            bent[at] ^= mask;
            if let Ok(mut loaded) = gltf::load_slice(&bent, None, "made.glb", None) {
                [0.3, 1e9].iter().for_each(|seconds| loaded.scene.set_time(*seconds));
            }
        }
    }
}

#[test]
fn a_small_file_cannot_ask_for_much_memory_or_time() {
    // Many nodes, each with a mesh of many primitives.
    let mut make = Make::square();
    let primitive = make.primitive().clone();
    make.json["meshes"][0]["primitives"] = json!(vec![primitive; 1100]);
    make.json["nodes"] = json!(vec![json!({"mesh": 0}); 1000]);
    make.json["scenes"][0]["nodes"] = (0..1000).collect();
    check("draws", &make.glb(), "the nodes show more than 1048576 primitives");

    // A hierarchy too deep for recursion.
    let mut make = Make::square();
    make.json["nodes"] = (0..200_000).map(|i| json!({"children": [i + 1]})).collect();
    push(&mut make.json["nodes"], json!({"mesh": 0}));
    assert_eq!(make.scene().triangle_count(), 2);
}

#[test]
fn a_file_that_is_not_there_or_no_file_is_named() {
    for (path, expected) in [("/nowhere/none.glb", "/nowhere/none.glb: cannot be read"), (env!("CARGO_MANIFEST_DIR"), ": is not a file")] {
        let error = gltf::load(path.as_ref(), None).unwrap_err();
        assert!(format!("{error:#}").contains(expected), "{error:#}");
        assert_eq!(exit_code(&error), Exit::BadInput);
    }
}
