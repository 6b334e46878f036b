//! Coloured panels in the sun, whose light colours the shade across the street: hoardings on houses, panels that stand on the street, flags.

use super::facade::Front;
use super::lots::House;
use super::meshes::{Meshes, mix};
use super::shops::rod;
use super::{BAY, FRONT, Plan, place};
use crate::scene::builder::Mesh;
use crate::scene::builtin::parts::Part;
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Bays on the sunny side with a panel in place of a car, and its colour.
pub const STANDS: [(i32, usize); 6] = [(-6, 0), (-4, 2), (-1, 3), (1, 1), (4, 0), (6, 2)];
/// Place of the panels across the street: the sun shines there over all houses at +z.
const LINE: f32 = -3.45;

pub fn parts(plan: &Plan) -> Vec<Part> {
    let palette = &plan.palette;
    let places: Vec<_> = STANDS.iter().map(|(bay, color)| (place(BAY * *bay as f32, 0.0, LINE, 0.0), palette.panels[*color])).collect();
    let (panel, [steel, stone]) = stand(plan);
    let mut parts = vec![Part::painted(panel, &places)];
    let transforms: Vec<_> = places.iter().map(|(transform, _)| *transform).collect();
    parts.push(Part::at(steel, palette.steel, transforms.clone()));
    parts.push(Part::at(stone, palette.kerb, transforms));
    // Places along the street between windows, sides of the street and colours.
    let flags: [(f32, f32, usize); 9] = [
        (-49.5, -1.0, 2),
        (-7.2, -1.0, 3),
        (3.0, -1.0, 1),
        (23.0, -1.0, 0),
        (42.0, -1.0, 3),
        (-42.5, 1.0, 0),
        (-22.0, 1.0, 1),
        (10.5, 1.0, 2),
        (49.0, 1.0, 3),
    ];
    let places: Vec<_> = flags
        .iter()
        .map(|(x, side, color)| (place(*x, 5.6, side * (FRONT - 0.1), if *side > 0.0 { PI } else { 0.0 }), palette.flags[*color]))
        .collect();
    let (pole, cloth) = flag(plan);
    parts.push(Part::painted(cloth, &places));
    let transforms: Vec<_> = places.iter().map(|(transform, _)| *transform).collect();
    parts.push(Part::merged(&pole, palette.steel, &transforms));
    parts
}

/// A panel that leans back a little, and its frame of steel and weights of stone.
fn stand(plan: &Plan) -> (Mesh, [Mesh; 2]) {
    let (half, foot, height, lean) = (2.35, 0.35, 3.1, 0.14);
    let mut panel = Mesh::default();
    let mut board = Mesh::default();
    board.solid(Vec3::new(-half, 0.0, -0.05), Vec3::new(half, height, 0.05), plan.cell(), 1.0);
    let leaning = Affine3A::from_rotation_translation(Quat::from_rotation_x(-lean), Vec3::new(0.0, foot, 0.0));
    panel.append(&board, leaning);
    let (mut steel, mut stone) = (Mesh::default(), Mesh::default());
    let on = |x: f32, y: f32, z: f32| leaning.transform_point3(Vec3::new(x, y, z));
    for x in [-1.7, 1.7] {
        rod(&mut steel, Vec3::new(x, 0.05, 0.02), on(x, height - 0.2, -0.08), 0.035);
        rod(&mut steel, Vec3::new(x, 0.05, -1.15), on(x, 2.0, -0.08), 0.03);
        rod(&mut steel, Vec3::new(x, 0.10, 0.25), Vec3::new(x, 0.10, -1.2), 0.035);
        stone.solid(Vec3::new(x - 0.25, -0.02, -1.35), Vec3::new(x + 0.25, 0.28, -0.95), plan.cell(), 1.5);
        stone.solid(Vec3::new(x - 0.25, -0.02, 0.05), Vec3::new(x + 0.25, 0.2, 0.4), plan.cell(), 1.5);
    }
    (panel, [steel, stone])
}

/// A hoarding on a front without windows.
pub fn hoarding(out: &mut Meshes, house: &House, front: &Front, color: usize, plan: &Plan) {
    let (x, y) = ([0.7, front.width - 0.7], [house.lot.ground() + 0.7, house.eaves() - 0.95]);
    let z = front.z;
    let (min, max) = (Vec3::new(x[0], y[0], z), Vec3::new(x[1], y[1], z + 0.12));
    out.of(plan.palette.panels[color]).divided_cuboid(min, max, "-x+x-y+y+z", plan.cell(), 1.0);
    let frame = out.of(plan.palette.frames);
    let wide = 0.12;
    for [x0, x1, y0, y1] in [
        [x[0] - wide, x[1] + wide, y[0] - wide, y[0] + 0.02],
        [x[0] - wide, x[1] + wide, y[1] - 0.02, y[1] + wide],
        [x[0] - wide, x[0] + 0.02, y[0] + 0.02, y[1] - 0.02],
        [x[1] - 0.02, x[1] + wide, y[0] + 0.02, y[1] - 0.02],
    ] {
        frame.divided_cuboid(Vec3::new(x0, y0, z), Vec3::new(x1, y1, z + 0.17), "-x+x-y+y+z", plan.cell(), 1.5);
    }
    // Lamps on arms light it at night.
    for i in 0..if plan.detail.shows(0.5) { 3 } else { 0 } {
        let at = mix(x[0], x[1], (i as f32 + 0.5) / 3.0);
        let iron = out.of(plan.palette.iron);
        rod(iron, Vec3::new(at, y[1] + 0.2, z), Vec3::new(at, y[1] + 0.42, z + 0.7), 0.02);
        iron.solid(Vec3::new(at - 0.16, y[1] + 0.34, z + 0.64), Vec3::new(at + 0.16, y[1] + 0.46, z + 0.82), f32::INFINITY, 1.0);
    }
}

/// A pole that rises out of a wall, and the flag that hangs from it.
fn flag(plan: &Plan) -> (Mesh, Mesh) {
    let (root, tip) = (Vec3::ZERO, Vec3::new(0.0, 1.15, 1.75));
    let mut pole = Mesh::default();
    rod(&mut pole, root - (tip - root) * 0.1, tip, 0.028);
    let mut cloth = Mesh::default();
    let cells = [plan.detail.count(22.0, 3), plan.detail.count(26.0, 4)];
    // From the pole's middle to its tip, and down.
    let shape = |u: f32, v: f32| {
        let hook = root.lerp(tip, 0.30 + 0.68 * u);
        let drop = 2.3 * v;
        let swing = v.powf(0.7);
        let wave = 0.12 * (TAU * 1.6 * u + 2.4 * v).sin() + 0.05 * (TAU * 3.3 * u - 3.0 * v).sin();
        let gathered = hook.z * (1.0 - 0.12 * v);
        Vec3::new(swing * wave, hook.y - 0.035 - drop, gathered)
    };
    cloth.surface(cells, false, shape, |u, v| Vec2::new(u * 1.6, v * 2.6));
    (pole, cloth)
}
