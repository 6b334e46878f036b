//! The Cornell box: the published measurements of the Cornell University Program of Computer Graphics.

use crate::scene::builder::Mesh;
use crate::scene::{Camera, Light, Material, Scene, SpotFalloff};
use glam::{Affine3A, Vec2, Vec3};

/// The measured room, millimetres: x to the left of the viewer, y up, z into the room; here turned by half a circle, centred, and of 0.01 m each.
const FLOOR: [[f32; 3]; 4] = [[552.8, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 559.2], [549.6, 0.0, 559.2]];
const CEILING: [[f32; 3]; 4] = [[556.0, 548.8, 0.0], [556.0, 548.8, 559.2], [0.0, 548.8, 559.2], [0.0, 548.8, 0.0]];
const BACK: [[f32; 3]; 4] = [[549.6, 0.0, 559.2], [0.0, 0.0, 559.2], [0.0, 548.8, 559.2], [556.0, 548.8, 559.2]];
const RIGHT: [[f32; 3]; 4] = [[0.0, 0.0, 559.2], [0.0, 0.0, 0.0], [0.0, 548.8, 0.0], [0.0, 548.8, 559.2]];
const LEFT: [[f32; 3]; 4] = [[552.8, 0.0, 0.0], [549.6, 0.0, 559.2], [556.0, 548.8, 559.2], [556.0, 548.8, 0.0]];
/// The tops of the blocks: their sides go straight down to the floor.
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

/// From the published coordinates to the scene's.
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
