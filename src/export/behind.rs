//! The picture's part behind single-sided surfaces: ours shows it through their backs, other renderers do not.

use crate::scene::Scene;
use crate::world::projection::View;
use glam::Vec3;

/// Rays across and down, enough to find areas that a user would notice.
const RAYS: [usize; 2] = [160, 90];

/// Share of the picture, 0 to 1, whose nearest surface is the back of a single-sided one. Masked surfaces count as holes.
pub fn seen_through(scene: &Scene, view: &View) -> f32 {
    let [width, height] = RAYS.map(|rays| rays as f32);
    let (right, up, forward) = (Vec3::from(view.right), Vec3::from(view.up), Vec3::from(view.forward));
    // Coordinates on the picture's axes: a ray goes along (x, y, 1), x and y in [-1, 1].
    let local = |p: Vec3| {
        let p = p - Vec3::from(view.position);
        Vec3::new(p.dot(right) / right.length_squared(), p.dot(up) / up.length_squared(), p.dot(forward))
    };
    let column = |x: f32| ((x * 0.5 + 0.5) * width).clamp(0.0, width) as usize;
    let row = |y: f32| ((y * 0.5 + 0.5) * height).clamp(0.0, height) as usize;
    let mut nearest = vec![(f32::INFINITY, false); RAYS[0] * RAYS[1]];
    for draw in &scene.draws {
        let material = &scene.materials[draw.material as usize];
        if material.alpha_cutoff.is_some() {
            continue;
        }
        let corners: Vec<Vec3> =
            scene.draw_vertices(draw).map(|vertex| local(draw.transform.transform_point3(vertex.position.into()))).collect();
        for corner in corners.chunks_exact(3) {
            let (a, b, c) = (corner[0], corner[1], corner[2]);
            if a.z.max(b.z).max(c.z) <= view.near {
                continue;
            }
            // Intersection by Cramer's rule. The axes are left-handed, so that front faces have a positive volume.
            let (bc, ca, ab) = (b.cross(c), c.cross(a), a.cross(b));
            let volume = a.dot(bc);
            let hidden = volume < 0.0 && !material.double_sided;
            let (mut columns, mut rows) = (0..RAYS[0], 0..RAYS[1]);
            if a.z.min(b.z).min(c.z) > view.near {
                let [x, y] = [[a.x / a.z, b.x / b.z, c.x / c.z], [a.y / a.z, b.y / b.z, c.y / c.z]];
                let span = |v: [f32; 3]| (v[0].min(v[1]).min(v[2]), v[0].max(v[1]).max(v[2]));
                let (x, y) = (span(x), span(y));
                columns = column(x.0)..(column(x.1) + 1).min(RAYS[0]);
                rows = row(y.0)..(row(y.1) + 1).min(RAYS[1]);
            }
            for j in rows {
                for i in columns.clone() {
                    let ray = Vec3::new((i as f32 + 0.5) / width * 2.0 - 1.0, (j as f32 + 0.5) / height * 2.0 - 1.0, 1.0);
                    let parts = Vec3::new(ray.dot(bc), ray.dot(ca), ray.dot(ab)) * volume.signum();
                    let distance = volume.abs() / parts.element_sum();
                    let pixel = &mut nearest[j * RAYS[0] + i];
                    if parts.min_element() >= 0.0 && distance > view.near && distance < pixel.0 {
                        *pixel = (distance, hidden);
                    }
                }
            }
        }
    }
    nearest.iter().filter(|(_, hidden)| *hidden).count() as f32 / nearest.len() as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, builtin};

    fn share(scene: &Scene, position: Vec3) -> f32 {
        let camera =
            Camera { name: String::new(), position, target: Vec3::new(0.0, 2.74, 0.0), up: Vec3::Y, fov_y_deg: scene.cameras[0].fov_y_deg };
        seen_through(scene, &View::new(&camera, [160, 90], scene.bounds()))
    }

    #[test]
    fn a_box_has_nothing_to_look_through_at_its_open_side_alone() {
        let mut scene = builtin::cornell();
        assert_eq!(share(&scene, Vec3::new(0.0, 2.74, 10.9)), 0.0);
        assert_eq!(share(&scene, Vec3::new(0.0, 2.74, 1.0)), 0.0, "inside, where triangles cross the near plane");
        let behind = share(&scene, Vec3::new(0.0, 2.74, -10.9));
        assert!((0.3..0.6).contains(&behind), "the back wall's share of the picture: {behind}");
        scene.materials.iter_mut().for_each(|material| material.double_sided = true);
        assert_eq!(share(&scene, Vec3::new(0.0, 2.74, -10.9)), 0.0);
    }
}
