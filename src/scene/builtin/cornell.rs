//! The Cornell box: the published measurements of the Cornell University Program of Computer Graphics.

use crate::scene::builder::Mesh;
use crate::scene::{Camera, Light, Material, Scene, SpotFalloff};
use glam::{Affine3A, Vec2, Vec3};

/// The measured room, mm: x to the left of the viewer, y up, z into the room. [`place`] turns it by half a circle, centres it
/// and scales it to 0.01 m per mm.
const FLOOR: [[f32; 3]; 4] = [[552.8, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 559.2], [549.6, 0.0, 559.2]];
const CEILING: [[f32; 3]; 4] = [[556.0, 548.8, 0.0], [556.0, 548.8, 559.2], [0.0, 548.8, 559.2], [0.0, 548.8, 0.0]];
const BACK: [[f32; 3]; 4] = [[549.6, 0.0, 559.2], [0.0, 0.0, 559.2], [0.0, 548.8, 559.2], [556.0, 548.8, 559.2]];
const RIGHT: [[f32; 3]; 4] = [[0.0, 0.0, 559.2], [0.0, 0.0, 0.0], [0.0, 548.8, 0.0], [0.0, 548.8, 559.2]];
const LEFT: [[f32; 3]; 4] = [[552.8, 0.0, 0.0], [549.6, 0.0, 559.2], [556.0, 548.8, 559.2], [556.0, 548.8, 0.0]];
/// The tops of the blocks, whose sides go straight down to the floor.
const SHORT_TOP: [[f32; 3]; 4] = [[130.0, 165.0, 65.0], [82.0, 165.0, 225.0], [240.0, 165.0, 272.0], [290.0, 165.0, 114.0]];
const TALL_TOP: [[f32; 3]; 4] = [[423.0, 330.0, 247.0], [265.0, 330.0, 296.0], [314.0, 330.0, 456.0], [472.0, 330.0, 406.0]];

/// The classic box with two blocks, 5.5 m wide, red on the viewer's left and open towards +Z; 30 triangles.
pub fn cornell() -> Scene {
    let mut scene = Scene { name: "cornell".into(), ..Scene::default() };
    let mut material = |name: &str, [r, g, b]: [f32; 3]| {
        scene.add_material(Material { name: name.into(), base_color: [r, g, b, 1.0], ..Material::default() })
    };
    let white = material("white", [0.7295, 0.7355, 0.729]);
    let red = material("red", [0.611, 0.0555, 0.062]);
    let green = material("green", [0.117, 0.4125, 0.115]);

    for (corners, material) in [(FLOOR, white), (CEILING, white), (BACK, white), (RIGHT, green), (LEFT, red)] {
        let mut wall = Mesh::default();
        quad(&mut wall, corners.map(place), Vec3::new(0.0, 2.74, 0.0), true);
        scene.add_mesh(&wall, material, &[Affine3A::IDENTITY]);
    }
    for top in [SHORT_TOP, TALL_TOP] {
        let top = top.map(place);
        let mut block = Mesh::default();
        let center = top.iter().sum::<Vec3>() / 4.0 - Vec3::Y * 0.5 * top[0].y;
        quad(&mut block, top, center, false);
        for i in 0..4 {
            let (a, b) = (top[i], top[(i + 1) % 4]);
            let foot = |p: Vec3| Vec3::new(p.x, 0.0, p.z);
            quad(&mut block, [a, b, foot(b), foot(a)], center, false);
        }
        scene.add_mesh(&block, white, &[Affine3A::IDENTITY]);
    }
    scene.lights.push(Light::Spot {
        position: Vec3::new(-0.4, 5.2, 1.2),
        direction: Vec3::new(0.35, -0.9, -0.55).normalize(),
        intensity: Vec3::new(120.0, 110.0, 95.0),
        inner: 24f32.to_radians(),
        outer: 28f32.to_radians(),
        falloff: SpotFalloff::Angle,
    });
    scene.cameras.push(Camera {
        name: "front".into(),
        position: Vec3::new(0.0, 2.74, 10.9),
        target: Vec3::new(0.0, 2.74, 0.0),
        up: Vec3::Y,
        fov_y_deg: 37.0,
    });
    scene
}

/// Scene coordinates of published ones.
fn place([x, y, z]: [f32; 3]) -> Vec3 {
    Vec3::new(278.0 - x, y, 279.6 - z) * 0.01
}

/// A quadrilateral that faces the point `center`, or away from it.
fn quad(mesh: &mut Mesh, mut corners: [Vec3; 4], center: Vec3, towards: bool) {
    let normal = (corners[1] - corners[0]).cross(corners[3] - corners[0]);
    if (normal.dot(center - corners[0]) > 0.0) != towards {
        corners.reverse();
    }
    mesh.quad(corners, [Vec2::new(0.0, 1.0), Vec2::ONE, Vec2::new(1.0, 0.0), Vec2::ZERO]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Aabb, pack};

    #[test]
    fn the_box_has_five_walls_that_face_inwards_and_two_blocks_that_face_outwards() {
        let scene = cornell();
        assert_eq!((scene.draws.len(), scene.triangle_count()), (7, 30));
        for (i, draw) in scene.draws.iter().enumerate() {
            let indices = &scene.indices[draw.first_index as usize..(draw.first_index + draw.index_count) as usize];
            assert_eq!(indices.len(), if i < 5 { 6 } else { 30 });
            let block = scene.draw_bounds(draw).center();
            for triangle in indices.chunks(3) {
                let [a, b, c] = [0, 1, 2].map(|k| scene.vertices[(draw.vertex_offset + triangle[k]) as usize]);
                let [pa, pb, pc] = [a, b, c].map(|v| Vec3::from(v.position));
                let front = (pb - pa).cross(pc - pa).normalize();
                assert!(front.dot(pack::octahedral_snorm16_inverse(a.normal)) > 0.999);
                if i < 5 {
                    assert!(front.dot(Vec3::new(0.0, 2.74, 0.0) - pa) > 2.0, "wall {i} faces away from the room");
                } else {
                    assert!(front.dot(pa - block) > 0.4, "a side of block {i} faces its middle");
                }
            }
        }
    }

    #[test]
    fn the_box_is_centred_open_to_the_front_and_red_on_the_left() {
        let scene = cornell();
        let bounds = scene.draws.iter().fold(Aabb::EMPTY, |all, draw| all.union(scene.draw_bounds(draw)));
        assert!(bounds.min.distance(Vec3::new(-2.78, 0.0, -2.796)) < 1e-4, "{}", bounds.min);
        assert!(bounds.max.distance(Vec3::new(2.78, 5.488, 2.796)) < 1e-4, "{}", bounds.max);
        let red = scene.draws.iter().find(|d| scene.materials[d.material as usize].name == "red").unwrap();
        assert!(scene.draw_bounds(red).max.x < -2.7);
        assert!(scene.cameras[0].position.z > bounds.max.z);
        let heights: Vec<f32> = scene.draws[5..].iter().map(|d| scene.draw_bounds(d).max.y).collect();
        assert_eq!(heights, [1.65, 3.3]);
    }
}
