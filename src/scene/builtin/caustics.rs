//! Metal objects on a floor that cast caustics: a scene for glossy virtual point lights.

use crate::scene::builder::Mesh;
use crate::scene::{Camera, Light, Material, Scene, SpotFalloff};
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::TAU;

/// Parameters of the metal objects.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Caustics {
    /// Triangles in all, at least 8,000; an odd number is rounded down.
    pub triangles: u32,
    /// GGX alpha of the metal; a glTF material's roughness is its square root.
    pub roughness: f32,
}

/// Half the room's width and depth, and its height, metres.
const ROOM: Vec3 = Vec3::new(2.4, 2.6, 2.4);

/// A gold and a silver ring, a hammered copper bowl on its side and a ribbed aluminium pipe in a room that is open to the front.
pub fn caustics(config: &Caustics) -> Scene {
    let mut scene = Scene { name: "caustics".into(), ..Scene::default() };
    let mut metal = |name: &str, [r, g, b]: [f32; 3]| {
        let roughness = config.roughness.sqrt();
        scene.add_material(Material { name: name.into(), base_color: [r, g, b, 1.0], metallic: 1.0, roughness, ..Material::default() })
    };
    let gold = metal("gold", [1.0, 0.78, 0.34]);
    let silver = metal("silver", [0.95, 0.93, 0.88]);
    let copper = metal("copper", [0.955, 0.64, 0.54]);
    let aluminium = metal("aluminium", [0.91, 0.92, 0.92]);
    let mut matte = |name: &str, [r, g, b]: [f32; 3]| {
        scene.add_material(Material { name: name.into(), base_color: [r, g, b, 1.0], ..Material::default() })
    };
    let stone = matte("stone", [0.62, 0.6, 0.56]);
    let red = matte("red", [0.5, 0.12, 0.09]);
    let blue = matte("blue", [0.1, 0.18, 0.42]);

    // Triangles beyond the walls' are shared out among the objects by size; the floor takes the rest, so that the sum is exact.
    let scale = (f64::from(config.triangles.saturating_sub(60)) / 8_100.0).sqrt() as f32;
    let cells = |u: f32, v: f32| [u, v].map(|n| ((n * scale).floor() as usize).max(4));
    let at = |position: [f32; 3]| Affine3A::from_translation(position.into());
    let things = [
        (ring(0.5, 0.26, 0.02, cells(110.0, 8.0)), gold, at([-0.35, 0.0, 0.55])),
        (ring(0.3, 0.16, 0.015, cells(80.0, 8.0)), silver, at([0.85, 0.0, 0.75])),
        (
            bowl(0.45, 0.02, cells(62.0, 28.0)),
            copper,
            Affine3A::from_rotation_translation(Quat::from_rotation_y(0.85) * Quat::from_rotation_x(1.15), Vec3::new(-0.75, 0.44, -0.75)),
        ),
        (
            pipe(0.13, 1.5, 9.0, cells(24.0, 34.0)),
            aluminium,
            Affine3A::from_rotation_translation(Quat::from_rotation_y(0.5), Vec3::new(0.95, 0.142, -0.55)),
        ),
    ];
    let mut used = 0;
    for (mesh, material, place) in &things {
        scene.add_mesh(mesh, *material, &[*place]);
        used += mesh.triangle_count();
    }
    let Vec3 { x, y, z } = ROOM;
    // Walls go down below the floor: the floor's strips have corners along its edges that the walls lack, and surfaces that
    // merely met would show cracks.
    let below = -0.01;
    let up = Vec3::Y * (y - below);
    for (material, corner, right) in [
        (stone, Vec3::new(-x, below, -z), Vec3::X * 2.0 * x),
        (red, Vec3::new(-x, below, z), Vec3::NEG_Z * 2.0 * z),
        (blue, Vec3::new(x, below, -z), Vec3::Z * 2.0 * z),
    ] {
        let mut wall = Mesh::default();
        strips(&mut wall, corner, right, up, 1);
        scene.add_mesh(&wall, material, &[Affine3A::IDENTITY]);
        used += wall.triangle_count();
    }
    let mut floor = Mesh::default();
    let left = (config.triangles as usize).saturating_sub(used) / 2;
    strips(&mut floor, Vec3::new(-x, 0.0, z), Vec3::X * 2.0 * x, Vec3::NEG_Z * 2.0 * z, left.max(1));
    scene.add_mesh(&floor, stone, &[Affine3A::IDENTITY]);

    let (position, target) = (Vec3::new(1.7, 3.1, 2.3), Vec3::new(-0.05, 0.1, 0.05));
    scene.lights.push(Light::Spot {
        position,
        direction: (target - position).normalize(),
        intensity: Vec3::new(220.0, 205.0, 180.0),
        inner: 17f32.to_radians(),
        outer: 20f32.to_radians(),
        falloff: SpotFalloff::Angle,
    });
    scene.cameras.push(Camera {
        name: "front".into(),
        position: Vec3::new(0.1, 2.0, 3.6),
        target: Vec3::new(0.05, 0.15, 0.05),
        up: Vec3::Y,
        fov_y_deg: 38.0,
    });
    scene
}

/// A parallelogram that faces `right x up`, divided into strips.
fn strips(mesh: &mut Mesh, corner: Vec3, right: Vec3, up: Vec3, count: usize) {
    let normal = right.cross(up).normalize();
    mesh.patch(1, count, |u, v| (corner + right * u + up * v, normal, Vec2::new(u, v)));
}

/// A ring of a flat band with rounded rims, standing on the floor; its profile is a closed curve.
fn ring(radius: f32, height: f32, thickness: f32, [around, along]: [usize; 2]) -> Mesh {
    let mut mesh = Mesh::default();
    let half = 0.5 * thickness;
    let straight = height - thickness;
    // The profile goes up the outside, over the rim, down the inside, and under.
    let profile = |v: f32| {
        let (turn, part) = ((v * 4.0).floor(), (v * 4.0).fract());
        let (sin, cos) = (0.5 * TAU * part).sin_cos();
        match turn as i32 {
            0 => (Vec2::new(radius + half, half + straight * part), Vec2::X),
            1 => (Vec2::new(radius + half * cos, height - half + half * sin), Vec2::new(cos, sin)),
            2 => (Vec2::new(radius - half, height - half - straight * part), Vec2::NEG_X),
            3 => (Vec2::new(radius - half * cos, half - half * sin), Vec2::new(-cos, -sin)),
            _ => (Vec2::new(radius + half, half), Vec2::X),
        }
    };
    let along = along / 4 * 4;
    mesh.patch(around, along, |u, v| {
        let (point, normal) = profile(v);
        let (sin, cos) = (TAU * u).sin_cos();
        let turned = |p: Vec2| Vec3::new(p.x * cos, p.y, -p.x * sin);
        (turned(point), turned(normal), Vec2::new(u, v))
    });
    mesh
}

/// A hammered bowl open to +y, its middle at the origin.
fn bowl(radius: f32, thickness: f32, [around, along]: [usize; 2]) -> Mesh {
    let mut mesh = Mesh::default();
    let position = |u: f32, v: f32| {
        // The profile goes from the outer pole to the rim, and back to the inner pole.
        let (inside, part) = if v <= 0.5 { (false, 2.0 * v) } else { (true, 2.0 - 2.0 * v) };
        let polar = 0.5 * std::f32::consts::PI * part;
        let dents = (9.0 * TAU * u + 5.0 * polar).sin() * (11.0 * polar).sin() * part * (1.0 - part) * 4.0;
        let r = radius - if inside { thickness } else { 0.0 } - 0.006 * dents;
        let (sin, cos) = (TAU * u).sin_cos();
        Vec3::new(r * polar.sin() * cos, -r * polar.cos(), -r * polar.sin() * sin)
    };
    mesh.surface([around, along / 2 * 2], false, position, Vec2::new);
    mesh
}

/// A pipe along x with ribs around it, its middle at the origin.
fn pipe(radius: f32, length: f32, ribs: f32, [around, along]: [usize; 2]) -> Mesh {
    let mut mesh = Mesh::default();
    let position = |u: f32, v: f32| {
        let r = radius + 0.012 * (ribs * TAU * v).cos();
        let (sin, cos) = (TAU * u).sin_cos();
        Vec3::new((v - 0.5) * length, r * cos, r * sin)
    };
    mesh.surface([around, along], false, position, Vec2::new);
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::pack;

    #[test]
    fn the_scene_has_just_as_many_triangles_as_are_asked_for() {
        for triangles in [8_190, 100_000, 260_000] {
            assert_eq!(caustics(&Caustics { triangles, roughness: 0.1 }).triangle_count(), u64::from(triangles));
        }
    }

    #[test]
    fn its_normals_face_as_its_triangles_do_and_out_of_the_metal() {
        let scene = caustics(&Caustics { triangles: 8_190, roughness: 0.04 });
        for draw in &scene.draws {
            let indices = &scene.indices[draw.first_index as usize..(draw.first_index + draw.index_count) as usize];
            for triangle in indices.chunks(3) {
                let corners = [0, 1, 2].map(|k| scene.vertices[(draw.vertex_offset + triangle[k]) as usize]);
                let [a, b, c] = corners.map(|v| Vec3::from(v.position));
                let front = (b - a).cross(c - a).normalize();
                let turned = corners.map(|corner| front.dot(pack::octahedral_snorm16_inverse(corner.normal)));
                // At the bowl's rim a normal is between those of both sides.
                assert!(turned.iter().sum::<f32>() > 0.9 && turned.iter().all(|cosine| *cosine > -0.1), "{turned:?}");
            }
        }
        // The bowl's outer pole faces down, its inner one up.
        let bowl = bowl(0.45, 0.02, [62, 28]);
        let lowest = (0..bowl.positions.len()).min_by(|a, b| bowl.positions[*a].y.total_cmp(&bowl.positions[*b].y)).unwrap();
        assert!(bowl.normals[lowest].y < -0.9);
        let pipe = pipe(0.13, 1.5, 9.0, [24, 34]);
        assert!((0..pipe.positions.len()).all(|i| pipe.normals[i].dot(pipe.positions[i].with_x(0.0)) > 0.0));
        let ring = ring(0.5, 0.26, 0.02, [110, 8]);
        let inner = (0..ring.positions.len()).find(|i| Vec2::new(ring.positions[*i].x, ring.positions[*i].z).length() < 0.491).unwrap();
        assert!(ring.normals[inner].dot(ring.positions[inner].with_y(0.0)) < 0.0);
        assert!(scene.materials.iter().filter(|m| m.metallic == 1.0).all(|m| (m.roughness - 0.2).abs() < 1e-6));
    }
}
