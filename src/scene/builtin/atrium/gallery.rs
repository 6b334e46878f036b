//! The galleries behind the arcades: floors, vaults with transverse ribs below, timber ceilings above, walls with
//! pilasters, dadoes and doors.

use super::{CEILING, DEPTH, HALF, OUTER_WALL, PITCH, PLINTH, Part, Plan, SPRING, Side, UPPER, WALL, all_bays, corners};
use crate::scene::builder::Mesh;
use crate::scene::builtin::profile::Profile;
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};

/// Half the clear depth of a gallery, and the rise of its vaults.
const SPAN: f32 = (DEPTH - WALL) / 2.0;
const RISE: f32 = 1.22;
/// Projection of the vaults' ribs.
const RIB: f32 = 0.10;
/// Height of the dado on the lower walls.
const DADO: f32 = 1.25;
const ROOF_TOP: f32 = 11.6;

pub fn parts(plan: &Plan) -> Vec<Part> {
    let palette = &plan.palette;
    let mut parts = floors(plan);
    let bay = vault(PITCH / 2.0, SPAN, -(WALL + SPAN), plan);
    parts.push(Part::at(bay, palette.plaster_white, all_bays()));
    let corner = vault(SPAN, SPAN, -(WALL + SPAN), plan);
    let shifted = Affine3A::from_translation(Vec3::X * -(WALL + SPAN));
    parts.push(Part::at(corner, palette.plaster_white, corners().map(|c| c * shifted).to_vec()));

    let mut ribs = Vec::new();
    let mut wide = Vec::new();
    for side in Side::all() {
        ribs.extend(side.columns());
        wide.extend([-1.0, 1.0].map(|hand| side.frame * Affine3A::from_translation(Vec3::X * (hand * side.half()))));
    }
    for (places, half) in [(ribs, 0.17), (wide, WALL)] {
        let (rib, pilaster) = transverse(half, plan);
        parts.push(Part::merged(&rib, palette.stone, &places));
        parts.push(Part::merged(&pilaster, palette.stone, &places));
    }
    parts.extend(walls(plan));
    parts.extend(timber(plan));
    parts.extend(doors(plan));
    parts
}

/// A groined vault over `2a * 2b`, its centre at `z`: four sectors of two crossing elliptic barrels.
fn vault(a: f32, b: f32, z: f32, plan: &Plan) -> Mesh {
    let n = plan.detail.count(8.0, 2);
    let mut mesh = Mesh::default();
    for sector in 0..4 {
        let (along, across) = if sector % 2 == 0 { (a, b) } else { (b, a) };
        let hand = if sector < 2 { 1.0 } else { -1.0 };
        mesh.patch(n, if plan.detail.shows(0.2) { 2 * n } else { n }, |u, v| {
            let t = 2.0 * v - 1.0;
            let (sin, cos) = (FRAC_PI_2 * u * t).sin_cos();
            let (l, c) = (hand * along * (FRAC_PI_2 * u).sin(), across * sin);
            let normal = -Vec2::new(cos / RISE, sin / across).normalize();
            let y = SPRING[0] + RISE * cos;
            let uv = Vec2::new(l, across * FRAC_PI_2 * u * t) / 3.0;
            if sector % 2 == 0 {
                (Vec3::new(l, y, z + c), Vec3::new(0.0, normal.x, normal.y), uv)
            } else {
                (Vec3::new(c, y, z + l), Vec3::new(normal.y, normal.x, 0.0), uv)
            }
        });
    }
    mesh
}

/// A rib across the gallery, `2 half` wide, and the pilaster under its outer end.
fn transverse(half: f32, plan: &Plan) -> (Mesh, Mesh) {
    let n = plan.detail.count(18.0, 3);
    let z = -(WALL + SPAN);
    let point = |angle: f32, inset: f32| {
        let (sin, cos) = angle.sin_cos();
        Vec2::new(z + (SPAN - inset) * sin, SPRING[0] + (RISE - inset) * cos)
    };
    let mut rib = Mesh::default();
    rib.patch(n, 1, |u, v| {
        let angle = PI * (u - 0.5);
        let p = point(angle, RIB);
        let inward = -Vec2::new(angle.sin() / SPAN, angle.cos() / RISE).normalize();
        let x = half * (2.0 * v - 1.0);
        (Vec3::new(x, p.y, p.x), Vec3::new(0.0, inward.y, inward.x), Vec2::new(x, angle * SPAN) / 1.5)
    });
    for hand in [-1.0, 1.0].into_iter().filter(|_| plan.detail.shows(0.11)) {
        rib.patch(n, 1, |u, v| {
            let angle = PI * (u - 0.5);
            let p = point(angle, RIB - (RIB + 0.03) * v);
            (Vec3::new(hand * half, p.y, p.x), Vec3::X * hand, Vec2::new(angle * SPAN, v * RIB) / 1.5)
        });
    }
    let mut pilaster = Mesh::default();
    let mut band = |out: f32, from: f32, to: f32, faces: &str| {
        let wide = half + 0.02 + out;
        pilaster.cuboid(Vec3::new(-wide, from, -DEPTH - 0.05), Vec3::new(wide, to, -DEPTH + RIB + 0.02 + out), faces, 1.5);
    };
    if plan.detail.shows(0.3) {
        band(0.05, PLINTH, PLINTH + 0.22, "-x+x+y+z");
        band(0.03, SPRING[0] - 0.22, SPRING[0] - 0.13, "-x+x-y+y+z");
    }
    band(0.0, PLINTH, SPRING[0] - 0.12, "-x+x+z");
    band(0.06, SPRING[0] - 0.13, SPRING[0], "-x+x-y+y+z");
    (rib, pilaster)
}

/// Both galleries' floors, laid around the court in four lengths that meet in the corners.
fn floors(plan: &Plan) -> Vec<Part> {
    let (mut tiles, mut step) = (Mesh::default(), Mesh::default());
    // The lower gallery's floor ends under the columns, on a step of stone.
    let edge = 0.45;
    for (y, near) in [(PLINTH, edge), (UPPER, -WALL)] {
        ring(&mut tiles, y, near, plan, 1.2);
    }
    let nosing = Profile::from(edge + 0.12, 0.0)
        .line(edge + 0.12, PLINTH - 0.05)
        .curve((edge + 0.16, PLINTH - 0.02), (edge + 0.12, PLINTH), 2.0)
        .line(edge, PLINTH);
    step.frame(&nosing, Vec2::from(HALF), false, plan.cell(), plan.detail, 1.5);
    vec![Part::once(tiles, plan.palette.tiles), Part::once(step, plan.palette.stone)]
}

/// A level ring around the court, from `near` metres inside the columns' axes out to the walls, facing up.
fn ring(mesh: &mut Mesh, y: f32, near: f32, plan: &Plan, tile: f32) {
    let (inner, outer) = (Vec2::from(HALF) - near, Vec2::from(HALF) + DEPTH);
    for hand in [-1.0, 1.0] {
        let z = if hand < 0.0 { -outer.y } else { inner.y };
        let start = Vec3::new(-outer.x, y, z + outer.y - inner.y);
        mesh.plane(start, Vec3::X * 2.0 * outer.x, Vec3::NEG_Z * (outer.y - inner.y), plan.cell(), tile, Vec2::new(start.x, -start.z));
        let x = if hand < 0.0 { -outer.x } else { inner.x };
        let start = Vec3::new(x, y, inner.y);
        mesh.plane(start, Vec3::X * (outer.x - inner.x), Vec3::NEG_Z * 2.0 * inner.y, plan.cell(), tile, Vec2::new(x, -inner.y));
    }
}

/// The outer wall: plaster over a stone dado below, coloured plaster above, ashlar outside.
fn walls(plan: &Plan) -> Vec<Part> {
    let palette = &plan.palette;
    let (mut dado, mut lower, mut upper, mut outside, mut trim) =
        (Mesh::default(), Mesh::default(), Mesh::default(), Mesh::default(), Mesh::default());
    for side in Side::all() {
        let half = side.half() + DEPTH;
        let band = |mesh: &mut Mesh, from: f32, to: f32| {
            let mut wall = Mesh::default();
            let start = Vec3::new(-half, from, -DEPTH);
            wall.plane(start, Vec3::X * 2.0 * half, Vec3::Y * (to - from), plan.cell(), 3.0, Vec2::new(-half, from));
            mesh.append(&wall, side.frame);
        };
        band(&mut dado, PLINTH, DADO);
        band(&mut lower, DADO, UPPER - 0.1);
        band(&mut upper, UPPER, CEILING + 0.1);
        let far = half + OUTER_WALL;
        let mut face = Mesh::default();
        let start = Vec3::new(far, 0.0, -DEPTH - OUTER_WALL);
        face.plane(start, Vec3::NEG_X * 2.0 * far, Vec3::Y * ROOF_TOP, plan.cell() * 2.0, 3.0, Vec2::ZERO);
        outside.append(&face, side.frame);
    }
    // Mouldings on the inside of the outer wall, around the court: skirting, dado rail, and one at the upper floor.
    let half = Vec2::from(HALF) + DEPTH;
    let rail = Profile::from(-0.01, DADO - 0.06)
        .line(0.03, DADO - 0.05)
        .torus(0.02, DADO + 0.01, 3.0)
        .line(0.03, DADO + 0.03)
        .line(-0.01, DADO + 0.05);
    trim.frame(&rail, half, false, plan.cell(), plan.detail, 1.5);
    for (floor, height) in [(PLINTH, 0.16), (UPPER, 0.14)] {
        let skirting =
            Profile::from(0.035, floor).line(0.035, floor + height - 0.02).curve((0.03, floor + height), (-0.01, floor + height), 2.0);
        trim.frame(&skirting, half, false, plan.cell(), plan.detail, 1.5);
    }
    let coping = Profile::from(-0.01, ROOF_TOP - 0.2)
        .line(0.08, ROOF_TOP - 0.2)
        .line(0.08, ROOF_TOP)
        .line(-OUTER_WALL - 0.08, ROOF_TOP)
        .line(-OUTER_WALL - 0.08, ROOF_TOP - 0.2)
        .line(-OUTER_WALL + 0.01, ROOF_TOP - 0.2);
    trim.frame(&coping, half, false, 4.0 * plan.cell(), plan.detail, 1.5);
    vec![
        Part::once(dado, palette.plaster_umber),
        Part::once(lower, palette.plaster_ochre),
        Part::once(upper, palette.plaster_rose),
        Part::once(outside, palette.ashlar),
        Part::once(trim, palette.stone),
    ]
}

/// The boards and beams over the upper gallery.
fn timber(plan: &Plan) -> Vec<Part> {
    let mut boards = Mesh::default();
    let mut beams = Mesh::default();
    for side in Side::all() {
        let mut lane = Mesh::default();
        // The long sides' ceilings include the corners.
        let long = side.bays > 3;
        let half = if long { side.half() + DEPTH } else { side.half() - WALL };
        let start = Vec3::new(-half, CEILING, -DEPTH);
        lane.plane(start, Vec3::X * 2.0 * half, Vec3::Z * (DEPTH - WALL), plan.cell(), 1.5, Vec2::ZERO);
        boards.append(&lane, side.frame);
        let spacing = if plan.detail.shows(0.15) { 0.75 } else { 1.5 };
        let count = (2.0 * half / spacing).round() as usize;
        for i in 0..count {
            let x = -half + 2.0 * half * (i as f32 + 0.5) / count as f32;
            let mut beam = Mesh::default();
            beam.cuboid(Vec3::new(x - 0.08, CEILING - 0.2, -DEPTH), Vec3::new(x + 0.08, CEILING, -WALL), "-x+x-y", 1.5);
            beams.append(&beam, side.frame);
        }
    }
    vec![Part::once(boards, plan.palette.boards), Part::once(beams, plan.palette.wood)]
}

/// Doors in stone frames on the galleries' back walls.
fn doors(plan: &Plan) -> Vec<Part> {
    let (mut frame, mut leaf) = (Mesh::default(), Mesh::default());
    let mut bar = |x: (f32, f32), y: (f32, f32), out: f32| {
        frame.cuboid(
            Vec3::new(x.0, y.0, -0.02),
            Vec3::new(x.1, y.1, out),
            if plan.detail.shows(0.3) { "-x+x-y+y+z" } else { "-x+x+z" },
            1.5,
        );
    };
    bar((-0.86, -0.66), (0.0, 2.35), 0.09);
    bar((0.66, 0.86), (0.0, 2.35), 0.09);
    bar((-0.86, 0.86), (2.35, 2.58), 0.10);
    if plan.detail.shows(0.13) {
        bar((-0.96, 0.96), (2.58, 2.68), 0.18);
    }
    for hand in [-1.0, 1.0] {
        let (from, to) = if hand < 0.0 { (-0.66, -0.01) } else { (0.01, 0.66) };
        leaf.cuboid(Vec3::new(from, 0.0, -0.02), Vec3::new(to, 2.35, 0.03), "-x+x+z", 1.5);
        for (low, high) in [(0.15, 0.75), (0.9, 1.5), (1.65, 2.2)].into_iter().filter(|_| plan.detail.shows(0.3)) {
            leaf.cuboid(Vec3::new(from + 0.1, low, 0.0), Vec3::new(to - 0.1, high, 0.055), "-x+x-y+y+z", 1.5);
        }
    }
    let mut places = Vec::new();
    for side in Side::all() {
        for bay in 0..side.bays {
            let upper = bay % 2 == 1;
            let lower = side.bays == 3 && bay == 1 || side.bays == 8 && (bay == 2 || bay == 5);
            for (here, floor) in [(lower, PLINTH), (upper, UPPER)] {
                if here {
                    places.push(side.bay(bay) * Affine3A::from_translation(Vec3::new(0.0, floor, -DEPTH)));
                }
            }
        }
    }
    if !plan.detail.shows(0.04) {
        frame = Mesh::default();
    }
    vec![Part::merged(&frame, plan.palette.stone, &places), Part::merged(&leaf, plan.palette.wood, &places)]
}
