//! What tests of the built-in scenes look at: triangles in the world, and rays.

use crate::scene::{Draw, Scene, pack};
use glam::Vec3;

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
