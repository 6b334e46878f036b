//! The scenes beside the checkout, against the table that came with them.

use manylight::scene::gltf;
use manylight::scene::{Aabb, Scene};
use std::path::PathBuf;

/// File, triangles, and corners of the bounding box (to a hundredth), from the table that came with the scenes.
const TABLE: [(&str, u64, [f32; 3], [f32; 3]); 9] = [
    ("sponza_crytek", 262_266, [-19.21, -1.26, -11.83], [18.00, 14.29, 11.05]),
    ("sibenik", 73_555, [-20.14, 0.00, -8.50], [20.14, 30.61, 8.50]),
    ("conference", 277_552, [-4.28, -0.01, -4.43], [7.08, 2.73, 2.81]),
    ("sponza_dabrovic", 66_453, [-17.40, 0.00, -7.80], [17.42, 16.56, 7.80]),
    ("armadillo", 86_490, [-2.00, 0.00, -2.00], [2.00, 3.00, 2.00]),
    ("cornell_box", 30, [-2.78, 0.00, -2.80], [2.78, 5.49, 2.80]),
    ("caustics_metal", 54_328, [-2.00, 0.00, -2.00], [2.00, 2.40, 2.00]),
    ("urban_street", 50_822, [-17.20, 0.00, -45.00], [17.20, 25.75, 45.56]),
    ("museum_hall", 488_563, [-9.01, 0.00, -14.00], [9.00, 6.80, 14.00]),
];

fn folder() -> Option<PathBuf> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes");
    if !folder.is_dir() {
        eprintln!("SKIPPED: {} is missing, the scenes in it are not tested", folder.display());
        return None;
    }
    Some(folder)
}

fn bounds(scene: &Scene) -> Aabb {
    scene.draws.iter().map(|draw| scene.draw_bounds(draw)).fold(Aabb::EMPTY, Aabb::union)
}

#[test]
fn the_real_scenes_have_their_triangles_and_bounds() {
    let Some(folder) = folder() else { return };
    for (name, triangles, min, max) in TABLE {
        let start = std::time::Instant::now();
        let loaded = gltf::load(&folder.join(name).with_extension("glb"), None).unwrap();
        let scene = &loaded.scene;
        let time = start.elapsed().as_secs_f64();
        eprintln!(
            "{name}: {time:.3} s, {} vertices, {} materials, {} textures",
            scene.vertices.len(),
            scene.materials.len(),
            scene.textures.len()
        );
        assert_eq!(loaded.warnings, Vec::<String>::new(), "{name}");
        assert_eq!(scene.triangle_count(), triangles, "{name}");
        let bounds = bounds(scene);
        for axis in 0..3 {
            assert!((bounds.min[axis] - min[axis]).abs() < 0.0051, "{name}: {bounds:?}");
            assert!((bounds.max[axis] - max[axis]).abs() < 0.0051, "{name}: {bounds:?}");
        }
    }
}
