//! What tests of the built-in scenes look at: triangles in the world, and rays; and the checks that all large scenes pass.

use crate::scene::{Draw, Map, Material, Scene, pack};
use glam::Vec3;
use std::collections::BTreeMap;

/// Triangles of a draw in the world: corners, and normals of the vertices.
pub fn triangles<'a>(scene: &'a Scene, draw: &'a Draw) -> impl Iterator<Item = ([Vec3; 3], [Vec3; 3])> + 'a {
    let range = draw.first_index as usize..(draw.first_index + draw.index_count) as usize;
    let normals = draw.transform.matrix3.inverse().transpose();
    scene.indices[range].chunks_exact(3).map(move |t| {
        let vertex = |i: usize| &scene.vertices[(draw.vertex_offset + t[i]) as usize];
        (
            std::array::from_fn(|i| draw.transform.transform_point3(vertex(i).position.into())),
            std::array::from_fn(|i| (normals * pack::octahedral_snorm16_inverse(vertex(i).normal)).normalize()),
        )
    })
}

/// The nearest triangle hit by a ray: distance, material, and whether its front was hit.
pub fn hit(scene: &Scene, origin: Vec3, direction: Vec3) -> Option<(f32, usize, bool)> {
    let mut nearest: Option<(f32, usize, bool)> = None;
    for draw in &scene.draws {
        let bounds = scene.draw_bounds(draw);
        let (a, b) = ((bounds.min - origin) / direction, (bounds.max - origin) / direction);
        if a.min(b).max_element() > a.max(b).min_element() {
            continue;
        }
        for ([a, b, c], _) in triangles(scene, draw) {
            let (ab, ac) = (b - a, c - a);
            let p = direction.cross(ac);
            let determinant = ab.dot(p);
            if determinant.abs() < 1e-12 {
                continue;
            }
            let s = (origin - a) / determinant;
            let u = s.dot(p);
            let q = s.cross(ab);
            let (v, t) = (direction.dot(q), ac.dot(q));
            if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 1e-4 && nearest.is_none_or(|n| t < n.0) {
                nearest = Some((t, draw.material as usize, determinant > 0.0));
            }
        }
    }
    nearest
}

/// Checks that indices, materials and maps are in range and all numbers finite, that every material and every texture is used, and that
/// there are at most `most` draws.
pub fn check_ranges(scene: &Scene, most: usize) {
    assert!(scene.draws.len() <= most, "{} draws", scene.draws.len());
    for draw in &scene.draws {
        assert!(draw.transform.is_finite() && (draw.material as usize) < scene.materials.len());
        let range = draw.first_index as usize..(draw.first_index + draw.index_count) as usize;
        assert!(scene.indices[range].iter().all(|&i| ((draw.vertex_offset + i) as usize) < scene.vertices.len()));
    }
    assert!(scene.vertices.iter().all(|v| v.position.iter().chain(&v.uv).all(|c| c.is_finite())));
    let maps = |m: &Material| [m.base_color_map, m.metallic_roughness_map, m.emission_map, m.normal_map].into_iter().flatten();
    for material in &scene.materials {
        assert!(maps(material).all(|Map { texture, .. }| (texture as usize) < scene.textures.len()), "{}", material.name);
        assert!(scene.draws.iter().any(|d| scene.materials[d.material as usize].name == material.name), "{} is unused", material.name);
    }
    for (index, texture) in scene.textures.iter().enumerate() {
        assert!((256..=1024).contains(&texture.width) && texture.texels.len() == (texture.width * texture.height * 4) as usize);
        assert!(scene.materials.iter().flat_map(maps).any(|map| map.texture as usize == index), "{} is unused", texture.name);
    }
}

/// Checks that no more than `part` of the triangles have a normal on their back, and .1 % no area.
pub fn check_normals(scene: &Scene, part: f64) {
    let (mut all, mut degenerate) = (0usize, 0usize);
    let mut wrong: BTreeMap<&str, usize> = BTreeMap::new();
    for draw in &scene.draws {
        for ([a, b, c], normals) in triangles(scene, draw) {
            let area = (b - a).cross(c - a);
            all += 1;
            degenerate += usize::from(area.length() < 1e-9);
            if normals.iter().any(|n| n.dot(area) <= 0.0) {
                *wrong.entry(&scene.materials[draw.material as usize].name).or_default() += 1;
            }
        }
    }
    assert!(wrong.values().sum::<usize>() as f64 <= part * all as f64, "of {all} triangles have a normal on their back: {wrong:?}");
    assert!(degenerate as f64 <= 0.001 * all as f64, "{degenerate} of {all} triangles have no area");
}

/// Checks that eyes see fronts only, in `count` directions all around, and nothing at all only where `open` of eye and direction
/// is true.
pub fn check_sight(scene: &Scene, eyes: &[Vec3], count: usize, open: impl Fn(Vec3, Vec3) -> bool) {
    for &eye in eyes {
        for i in 0..count {
            let z = 1.0 - 2.0 * (i as f32 + 0.5) / count as f32;
            let (sin, cos) = (i as f32 * 2.399_963).sin_cos();
            let direction = Vec3::new((1.0 - z * z).sqrt() * cos, z, (1.0 - z * z).sqrt() * sin);
            match hit(scene, eye, direction) {
                Some((t, material, front)) => {
                    let material = &scene.materials[material];
                    assert!(front || material.double_sided, "from {eye} towards {direction}: the back of {} at {t} m", material.name);
                }
                None => assert!(open(eye, direction), "from {eye} towards {direction}: out through a gap"),
            }
        }
    }
}
