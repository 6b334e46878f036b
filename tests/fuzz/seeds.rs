//! Writes the seeds of fuzzing: one file for every feature of the loader.

#[allow(dead_code)]
#[path = "../gltf/make.rs"]
mod make;

use make::{F32, I16, Make, U8, U16, bytes, png};
use serde_json::json;
use std::path::Path;

fn main() -> anyhow::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus/scene");
    std::fs::create_dir_all(&folder)?;
    for (name, make) in makes() {
        std::fs::write(folder.join(format!("{name}.glb")), make.glb())?;
        let json = serde_json::to_vec(&make.document(None))?;
        std::fs::write(folder.join(format!("{name}.parts")), [&json, &b"\0"[..], &make.bin].concat())?;
    }
    Ok(())
}

fn makes() -> Vec<(&'static str, Make)> {
    let mut strip = Make::square();
    strip.primitive()["mode"] = json!(5);
    let mut fan = Make::square();
    fan.primitive().as_object_mut().map(|primitive| primitive.remove("indices"));
    fan.primitive()["attributes"].as_object_mut().map(|attributes| attributes.remove("NORMAL"));
    fan.primitive()["mode"] = json!(6);

    let mut textured = Make::textured(json!({
        "doubleSided": true, "alphaMode": "MASK", "emissiveFactor": [1, 1, 1], "normalTexture": {"index": 0},
        "emissiveTexture": {"index": 0, "extensions": {"KHR_texture_transform": {"offset": [0, 1], "rotation": 1, "scale": [2, 2], "texCoord": 0}}},
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0}},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 6}},
    }));
    textured.texture(&png(2, 2, &[90; 16]));
    textured.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    textured.json["textures"][0]["sampler"] = json!(0);

    let mut jpeg = Make::textured(json!({"emissiveTexture": {"index": 0}}));
    let mut file = std::io::Cursor::new(Vec::new());
    let image = image::RgbImage::from_pixel(8, 8, image::Rgb([200, 100, 50]));
    if image.write_to(&mut file, image::ImageFormat::Jpeg).is_ok() {
        jpeg.texture(&file.into_inner());
    }

    let mut sparse = Make::square();
    let (indices, values) = (sparse.view(&[1, 3]), sparse.view(&bytes(&[9.0f32, 0.0, 0.0, 0.0, 9.0, 0.0])));
    let replacement = json!({"count": 2, "indices": {"bufferView": indices, "componentType": U8}, "values": {"bufferView": values}});
    sparse.json["accessors"][0]["sparse"] = replacement;

    let mut quantized = Make::square();
    quantized.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    quantized.attribute("POSITION", I16, "VEC3", &bytes(&[0i16, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]));
    let colors = quantized.attribute("COLOR_0", U16, "VEC4", &bytes(&[9999u16; 16]));
    quantized.json["accessors"][colors]["normalized"] = json!(true);
    quantized.attribute("TANGENT", F32, "VEC4", &bytes(&[1.0f32; 16]));

    let mut places = Make::square();
    places.json["nodes"] = json!([
        {"children": [1, 2, 3], "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 10, 20, 30, 1]},
        {"mesh": 0, "rotation": [0, 0.6, 0, 0.8], "translation": [0, 1, 0], "scale": [-1, 1, 1]},
        {"camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}},
        {"mesh": 0, "extensions": {"KHR_lights_punctual": {"light": 1}}},
    ]);
    places.json["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1}}]);
    places.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "directional", "color": [1, 0.5, 0.25], "intensity": 8},
        {"type": "spot", "intensity": 2, "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}},
    ]}});
    let mut moving = places.clone();
    let (half, spline) = (std::f32::consts::FRAC_1_SQRT_2, [[0.0f32; 3], [1.0; 3], [0.5; 3], [-0.5; 3], [2.0; 3], [0.0; 3]]);
    moving.json["nodes"][0] = json!({"children": [1, 2, 3]});
    moving.animate(0, "rotation", "LINEAR", &[0.0, 1.5], &[0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half]);
    moving.animate(1, "scale", "STEP", &[0.5, 1.0], &[1.0, 2.0, 1.0, 0.0, 0.0, 0.0]);
    moving.animate(2, "translation", "CUBICSPLINE", &[0.0, 1.0], spline.as_flattened());

    let mut bending = Make::stretched();
    bending.influences(1, [[1; 4]; 4], [[0.25; 4]; 4]);
    bending.target([[0.0, 0.0, 1.0]; 4], Some([[0.0, 0.5, 0.0]; 4]));
    bending.animate(0, "weights", "CUBICSPLINE", &[0.0, 1.0], &[0.5; 6]);

    vec![
        ("square", Make::square()),
        ("strip", strip),
        ("fan", fan),
        ("textured", textured),
        ("jpeg", jpeg),
        ("sparse", sparse),
        ("quantized", quantized),
        ("places", places),
        ("moving", moving),
        ("bending", bending),
    ]
}
