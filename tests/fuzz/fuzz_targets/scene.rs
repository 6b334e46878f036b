//! Loading a scene from arbitrary bytes: no panic, no hang, no large allocation. An accepted scene must be consistent.
#![no_main]

use libfuzzer_sys::fuzz_target;
use manylight::scene::gltf::{self, Loaded};

fuzz_target!(|data: &[u8]| {
    check(gltf::load_slice(data, None, "fuzz", None));
    // JSON, a zero byte and a buffer: a .glb with correct lengths.
    if let Some(end) = data.iter().position(|&byte| byte == 0) {
        check(gltf::load_slice(&glb(&data[..end], &data[end + 1..]), None, "fuzz", None));
    }
});

fn check(loaded: anyhow::Result<Loaded>) {
    let Ok(Loaded { mut scene, .. }) = loaded else { return };
    assert!(!scene.draws.is_empty());
    for seconds in [0.0, 0.7, 1e9] {
        scene.set_time(seconds);
        for draw in &scene.draws {
            assert!(draw.index_count > 0 && draw.index_count.is_multiple_of(3));
            assert!((draw.material as usize) < scene.materials.len());
            assert!(draw.transform.is_finite());
            // Bounds are only checked for the file's own state: between samples an odd track may run away.
            let bounds = scene.draw_bounds(draw);
            assert!(seconds > 0.0 || bounds.min.is_finite() && bounds.max.is_finite());
        }
    }
    for vertex in &scene.vertices {
        assert!(vertex.uv.iter().all(|c| c.is_finite()));
    }
    for material in &scene.materials {
        let maps = [material.base_color_map, material.metallic_roughness_map, material.emission_map, material.normal_map];
        assert!(maps.iter().flatten().all(|map| (map.texture as usize) < scene.textures.len()));
    }
    for texture in &scene.textures {
        assert_eq!(texture.texels.len(), texture.width as usize * texture.height as usize * 4);
    }
}

fn glb(json: &[u8], bin: &[u8]) -> Vec<u8> {
    let chunk = |kind: &[u8], data: &[u8]| [&(data.len() as u32).to_le_bytes(), kind, data].concat();
    let body = [chunk(b"JSON", json), chunk(b"BIN\0", bin)].concat();
    [&b"glTF"[..], &2u32.to_le_bytes(), &(12 + body.len() as u32).to_le_bytes(), &body].concat()
}
