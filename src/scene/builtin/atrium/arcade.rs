//! The arcades' walls above the columns, with archivolts, keystones, roundels, string course and cornice.

use super::{HALF, PITCH, Part, Plan, RADIUS, SPRING, Side, UPPER, WALL, WALL_TOP, all_bays, all_columns};
use crate::scene::builder::Mesh;
use crate::scene::builtin::profile::Profile;
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::PI;

pub fn parts(plan: &Plan) -> Vec<Part> {
    let mut parts = Vec::new();
    for storey in 0..2 {
        let mut wall = Mesh::default();
        for side in Side::all() {
            wall.append(&side_wall(&side, storey, plan), side.frame);
        }
        parts.push(Part::once(wall, [plan.palette.ashlar, plan.palette.plaster_cream][storey]));
        parts.push(Part::at(archivolt(storey, plan), plan.palette.stone, all_bays()));
    }
    let (frame, disc) = roundel(plan);
    let places: Vec<_> = all_columns().into_iter().map(|c| c * Affine3A::from_translation(Vec3::new(0.0, SPRING[0] + 1.1, WALL))).collect();
    parts.push(Part::merged(&frame, plan.palette.stone, &places));
    parts.push(Part::merged(&disc, plan.palette.majolica, &places));
    parts.push(Part::once(mouldings(plan), plan.palette.stone));
    parts
}

/// The wall of one side from the springing line up, with a round opening in each bay.
fn side_wall(side: &Side, storey: usize, plan: &Plan) -> Mesh {
    const TILE: f32 = 3.0;
    let (spring, radius, top) = (SPRING[storey], RADIUS[storey], WALL_TOP[storey]);
    let segments = plan.detail.count(38.0, 4);
    let rows = ((0.5 * (top - spring - radius) / plan.cell()) as usize).max(1);
    let mut mesh = Mesh::default();
    for bay in 0..side.bays {
        let x = side.bay_x(bay);
        for face in [1.0, -1.0] {
            let z = face * WALL;
            let point = |px: f32, py: f32| (Vec3::new(px, py, z), Vec3::Z * face, Vec2::new(px * face, -py) / TILE);
            mesh.patch(segments, rows, |u, v| {
                let (sin, cos) = (PI * u).sin_cos();
                let arch = spring + radius * sin;
                point(x + radius * cos, arch + (top - arch) * v)
            });
            for hand in [-1.0, 1.0] {
                // On the back face, the walls of two sides meet beyond the corner.
                let outermost = bay == if hand < 0.0 { 0 } else { side.bays - 1 };
                let end = PITCH / 2.0 + if outermost && face < 0.0 { WALL } else { 0.0 };
                mesh.patch(1, if plan.detail.shows(0.4) { rows * 3 } else { 1 }, |u, v| {
                    point(x + hand * (radius + (end - radius) * u), spring + (top - spring) * v)
                });
            }
        }
        mesh.patch(segments, 1, |u, v| {
            let (sin, cos) = (PI * u).sin_cos();
            let position = Vec3::new(x + radius * cos, spring + radius * sin, (2.0 * v - 1.0) * WALL);
            (position, Vec3::new(-cos, -sin, 0.0), Vec2::new((v - 0.5) * 2.0 * WALL, PI * u * radius) / TILE)
        });
    }
    mesh
}

/// The moulded ring of an arch with its keystone on the court's side, and a plain ring on the gallery's side, in a bay's frame.
fn archivolt(storey: usize, plan: &Plan) -> Mesh {
    let r = RADIUS[storey];
    let profile = Profile::from(r - 0.015, -0.05)
        .line(r - 0.015, 0.035)
        .line(r + 0.075, 0.035)
        .line(r + 0.075, 0.055)
        .line(r + 0.155, 0.055)
        .curve((r + 0.165, 0.1), (r + 0.205, 0.1), 4.0)
        .line(r + 0.225, 0.1)
        .line(r + 0.225, -0.02);
    let mut mesh = Mesh::default();
    let segments = plan.detail.count(38.0, 4);
    mesh.archivolt(&profile, Vec3::new(0.0, SPRING[storey], WALL), segments, plan.detail, 1.5);
    let plain = Profile::from(r - 0.015, -0.05).line(r - 0.015, 0.03).line(r + 0.14, 0.03).line(r + 0.14, -0.02);
    let mut back = Mesh::default();
    if plan.detail.shows(0.28) {
        back.archivolt(&plain, Vec3::new(0.0, SPRING[storey], WALL), segments, plan.detail, 1.5);
    }
    mesh.append(&back, Affine3A::from_rotation_y(PI));
    if plan.detail.shows(0.09) {
        mesh.append(&keystone(r), Affine3A::from_translation(Vec3::new(0.0, SPRING[storey], WALL)));
    }
    mesh
}

/// A keystone: a wedge over the crown, in a frame on the springing line.
fn keystone(r: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let (foot, head, out) = ((0.095, r - 0.05), (0.15, r + 0.27), [0.13, 0.17]);
    let corner = |hand: f32, up: bool, front: bool| {
        let (x, y) = if up { head } else { foot };
        Vec3::new(hand * x, y, if front { out[usize::from(up)] } else { -0.1 })
    };
    let uvs = [Vec2::new(0.0, 0.2), Vec2::new(0.15, 0.2), Vec2::new(0.15, 0.0), Vec2::ZERO];
    let mut face = |a, b, c, d| mesh.quad([a, b, c, d], uvs);
    let (l, r) = (-1.0, 1.0);
    face(corner(l, false, true), corner(r, false, true), corner(r, true, true), corner(l, true, true));
    face(corner(r, false, true), corner(r, false, false), corner(r, true, false), corner(r, true, true));
    face(corner(l, false, false), corner(l, false, true), corner(l, true, true), corner(l, true, false));
    face(corner(l, true, true), corner(r, true, true), corner(r, true, false), corner(l, true, false));
    face(corner(l, false, false), corner(r, false, false), corner(r, false, true), corner(l, false, true));
    mesh
}

/// A round frame and the glazed disc in it, on the wall's face between two arches.
fn roundel(plan: &Plan) -> (Mesh, Mesh) {
    let sides = plan.detail.count(32.0, 5);
    let lying = Affine3A::from_rotation_x(PI / 2.0);
    let ring = Profile::from(0.31, -0.02)
        .line(0.31, 0.05)
        .curve((0.30, 0.075), (0.275, 0.075), 3.0)
        .curve((0.25, 0.075), (0.245, 0.04), 3.0)
        .line(0.225, 0.03)
        .line(0.225, -0.01);
    let mut frame = Mesh::default();
    if plan.detail.shows(0.1) {
        frame.lathe(&ring, sides, plan.detail, 1.5);
    }
    let mut disc = Mesh::default();
    let dome = Profile::from(0.228, 0.005).curve((0.19, 0.005), (0.17, 0.03), 3.0).curve((0.1, 0.06), (0.0, 0.06), 4.0);
    disc.lathe(&dome, sides, plan.detail, 0.5);
    let turned = |mesh: Mesh| {
        let mut upright = Mesh::default();
        upright.append(&mesh, lying);
        upright
    };
    (turned(frame), turned(disc))
}

/// String course under the upper floor, cornice under the roof, and the dentils of both, all around the court.
fn mouldings(plan: &Plan) -> Mesh {
    let half = Vec2::from(HALF);
    let mut mesh = Mesh::default();
    let string = Profile::from(WALL - 0.05, UPPER - 0.45)
        .line(WALL + 0.04, UPPER - 0.45)
        .line(WALL + 0.04, UPPER - 0.30)
        .line(WALL + 0.07, UPPER - 0.30)
        .line(WALL + 0.07, UPPER - 0.18)
        .curve((WALL + 0.09, UPPER - 0.12), (WALL + 0.17, UPPER - 0.11), 4.0)
        .line(WALL + 0.22, UPPER - 0.11)
        .line(WALL + 0.22, UPPER - 0.03)
        .torus(0.02, UPPER, 2.0)
        .line(-WALL, UPPER);
    mesh.frame(&string, half, false, plan.cell(), plan.detail, 1.5);
    let y = WALL_TOP[1] - 0.32;
    let cornice = Profile::from(WALL - 0.05, y)
        .line(WALL + 0.05, y)
        .torus(0.025, y + 0.06, 3.0)
        .line(WALL + 0.05, y + 0.22)
        .line(WALL + 0.22, y + 0.24)
        .line(WALL + 0.22, y + 0.34)
        .curve((WALL + 0.26, y + 0.36), (WALL + 0.30, y + 0.43), 3.0)
        .curve((WALL + 0.34, y + 0.50), (WALL + 0.40, y + 0.51), 3.0)
        .line(WALL + 0.40, super::EAVES);
    mesh.frame(&cornice, half, false, plan.cell(), plan.detail, 1.5);
    if plan.detail.shows(0.5) {
        for (bottom, height, width, gap, depth) in [(UPPER - 0.19, 0.08, 0.09, 0.10, 0.17), (y + 0.08, 0.16, 0.13, 0.17, 0.20)] {
            for side in Side::all() {
                let length = side.half() - WALL - 0.05;
                let count = (2.0 * length / (width + gap)) as usize;
                for i in 0..=count {
                    let x = -length + 2.0 * length * i as f32 / count as f32;
                    let mut block = Mesh::default();
                    let min = Vec3::new(x - width / 2.0, bottom, WALL);
                    block.cuboid(min, Vec3::new(x + width / 2.0, bottom + height, WALL + depth), "-x+x-y+z", 1.5);
                    mesh.append(&block, side.frame);
                }
            }
        }
    }
    mesh
}
