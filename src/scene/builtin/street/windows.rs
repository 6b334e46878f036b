//! What is in and around the openings of fronts: windows, doors, sills, bands, shutters and balconies.

use super::Plan;
use super::facade::{Front, Opening};
use super::houses::BELOW;
use super::lots::{Base, House};
use super::meshes::Meshes;
use crate::scene::builtin::noise::hash;
use glam::{Vec2, Vec3};

const TILE: f32 = 1.5;

/// One of four pictures in a texture: left, top, right and bottom of its part.
pub fn quarter(number: u32, seed: u32) -> [f32; 4] {
    let which = hash(number, 11, seed) % 4;
    let (left, top) = (0.5 * (which % 2) as f32, 0.5 * (which / 2) as f32);
    [left + 0.004, top + 0.004, left + 0.496, top + 0.496]
}

/// The glass of an opening, and its frame before it. The picture has a frame too, which shows where there is no other.
pub fn window(out: &mut Meshes, opening: &Opening, plan: &Plan) {
    let ([x0, x1], [y0, y1], z) = (opening.x, opening.y, opening.z);
    // The glass goes on behind the reveals, if there are some.
    let margin = if plan.detail.shows(0.1) { 0.03 } else { 0.0 };
    let picture = quarter(opening.number, plan.seed);
    out.of(plan.palette.glazing).picture([x0 - margin, x1 + margin], [y0 - margin, y1 + margin], z, picture, plan.cell());
    if !plan.detail.shows(0.42) {
        return;
    }
    let frames = out.of(plan.palette.frames);
    let (depth, wide, middle) = (0.055, 0.07, opening.middle());
    let mut bar = |x: [f32; 2], y: [f32; 2], out: f32, faces: &str| {
        frames.cuboid(Vec3::new(x[0], y[0], z), Vec3::new(x[1], y[1], z + out), faces, TILE);
    };
    bar([x0, x0 + wide], [y0, y1], depth, "+x+z");
    bar([x1 - wide, x1], [y0, y1], depth, "-x+z");
    bar([x0 + wide, x1 - wide], [y0, y0 + wide], depth, "+y+z");
    bar([x0 + wide, x1 - wide], [y1 - wide, y1], depth, "-y+z");
    bar([middle - 0.03, middle + 0.03], [y0 + wide, y1 - wide], depth * 0.9, "-x+x+z");
    let transom = y0 + 0.66 * (y1 - y0);
    bar([x0 + wide, x1 - wide], [transom - 0.025, transom + 0.025], depth * 0.8, "-y+y+z");
    // Glazing bars, in the finest of windows.
    if plan.detail.shows(1.7) {
        for t in [0.22, 0.44] {
            let y = y0 + t * (y1 - y0);
            bar([x0 + wide, x1 - wide], [y - 0.012, y + 0.012], depth * 0.5, "-y+y+z");
        }
    }
}

pub fn sill(out: &mut Meshes, opening: &Opening, wall: f32, plan: &Plan) {
    if !plan.detail.shows(0.12) {
        return;
    }
    let ([x0, x1], y) = (opening.x, opening.y[0]);
    out.of(plan.palette.limestone).block([x0 - 0.12, x1 + 0.12], [y - 0.08, y + 0.015], [opening.z, wall + 0.09], TILE);
}

/// Flat bands at both sides of an opening and over it.
pub fn bands(out: &mut Meshes, opening: &Opening, wall: f32, plan: &Plan) {
    let ([x0, x1], [y0, y1]) = (opening.x, opening.y);
    let stone = out.of(plan.palette.lime);
    let mut band = |x: [f32; 2], y: [f32; 2], out: f32, faces: &str| {
        stone.divided_cuboid(Vec3::new(x[0], y[0], wall), Vec3::new(x[1], y[1], wall + out), faces, plan.cell(), 3.0);
    };
    band([x0 - 0.15, x0], [y0, y1], 0.045, "-x+x+z");
    band([x1, x1 + 0.15], [y0, y1], 0.045, "-x+x+z");
    band([x0 - 0.15, x1 + 0.15], [y1, y1 + 0.17], 0.06, "-x+x-y+y+z");
    // A keystone.
    if plan.detail.shows(0.7) {
        let middle = opening.middle();
        stone.block([middle - 0.09, middle + 0.09], [y1 - 0.03, y1 + 0.20], [wall, wall + 0.09], 3.0);
    }
}

/// A small cornice over an opening with bands.
pub fn hood(out: &mut Meshes, opening: &Opening, wall: f32, plan: &Plan) {
    let ([x0, x1], y) = (opening.x, opening.y[1]);
    let stone = out.of(plan.palette.limestone);
    stone.block([x0 - 0.22, x1 + 0.22], [y + 0.21, y + 0.27], [wall, wall + 0.12], TILE);
    stone.block([x0 - 0.26, x1 + 0.26], [y + 0.27, y + 0.33], [wall, wall + 0.18], TILE);
    if plan.detail.shows(0.5) {
        for x in [x0 - 0.14, x1 + 0.04] {
            stone.block([x, x + 0.10], [y - 0.02, y + 0.21], [wall, wall + 0.10], TILE);
        }
    }
}

/// Shutters, open at both sides of an opening.
pub fn shutters(out: &mut Meshes, opening: &Opening, wall: f32, paint: usize, plan: &Plan) {
    if !plan.detail.shows(0.08) {
        return;
    }
    let ([x0, x1], [y0, y1]) = (opening.x, [opening.y[0] - 0.02, opening.y[1] + 0.02]);
    let mesh = out.of(plan.palette.shutters[paint]);
    let half = 0.5 * (x1 - x0);
    let slats = if plan.detail.shows(0.6) { plan.detail.count(13.0, 6).min(26) } else { 0 };
    for x in [x0 - 0.03 - half, x1 + 0.03] {
        mesh.block([x, x + half], [y0, y1], [wall, wall + 0.04], 1.0);
        // Slats that lean outwards, between the stiles.
        for panel in [0, 1] {
            if slats == 0 {
                break;
            }
            let from = y0 + 0.08 + panel as f32 * 0.5 * (y1 - y0);
            let pitch = (0.5 * (y1 - y0) - 0.14) / slats as f32;
            for slat in 0..slats {
                let y = from + slat as f32 * pitch;
                let normal = Vec3::new(0.0, 0.028, 0.9 * pitch).normalize();
                mesh.patch(1, 1, |u, v| {
                    let at = Vec3::new(x + 0.06 + (half - 0.12) * u, y + 0.9 * pitch * v, wall + 0.042 + 0.028 * (1.0 - v));
                    (at, normal, Vec2::new(at.y, at.x))
                });
            }
        }
    }
}

/// A balcony before a French window: a slab on brackets and a railing.
pub fn balcony(out: &mut Meshes, opening: &Opening, wall: f32, plan: &Plan) {
    let ([x0, x1], floor) = ([opening.x[0] - 0.35, opening.x[1] + 0.35], opening.y[0] - 0.02);
    let depth = 0.85;
    let stone = out.of(plan.palette.limestone);
    stone.block([x0, x1], [floor - 0.15, floor], [wall - 0.02, wall + depth], TILE);
    for x in [x0 + 0.14, x1 - 0.30].into_iter().filter(|_| plan.detail.shows(0.3)) {
        stone.block([x, x + 0.16], [floor - 0.36, floor - 0.15], [wall - 0.02, wall + 0.45], TILE);
        stone.block([x + 0.01, x + 0.15], [floor - 0.56, floor - 0.36], [wall - 0.02, wall + 0.22], TILE);
    }
    if !plan.detail.shows(0.13) {
        return;
    }
    let iron = out.of(plan.palette.iron);
    let (front, rail) = (wall + depth - 0.06, floor + 0.98);
    let mut bar = |min: [f32; 3], max: [f32; 3], faces: &str| iron.cuboid(min.into(), max.into(), faces, TILE);
    for (y, half) in [(rail, 0.025), (floor + 0.10, 0.014)] {
        bar([x0 + 0.03, y - half, front - half], [x1 - 0.03, y + half, front + half], "-x+x-y+y-z+z");
        for x in [x0 + 0.05, x1 - 0.05] {
            bar([x - half, y - half * 0.96, wall], [x + half, y + half * 0.96, front], "-x+x-y+y");
        }
    }
    // Upright bars: fewer and wider if there are few triangles.
    let count = plan.detail.count(15.0, 3).min(15);
    let half = 0.009 * (15.0 / count as f32).sqrt();
    let mut upright = |x: f32, z: f32| bar([x - half, floor, z - half], [x + half, rail, z + half], "-x+x-z+z");
    for i in 0..count {
        let x = x0 + 0.05 + (x1 - x0 - 0.1) * i as f32 / (count - 1) as f32;
        upright(x, front);
    }
    let side = count * 2 / 5;
    for i in 0..side {
        let z = wall + (front - wall) * (i as f32 + 0.5) / side as f32;
        upright(x0 + 0.05, z);
        upright(x1 - 0.05, z);
    }
}

/// The door of a house, in a frame of stone, with a light over it.
pub fn door(out: &mut Meshes, house: &House, front: &Front, opening: &Opening, plan: &Plan) {
    let ([x0, x1], [y0, y1], z) = (opening.x, opening.y, opening.z);
    let Base::Home(paint) = house.lot.base else { return };
    let leaf = y1 - 0.55;
    out.of(plan.palette.glazing).picture([x0, x1], [y0 - 0.02, y1], z, quarter(opening.number, plan.seed), plan.cell());
    out.of(plan.palette.frames).cuboid(Vec3::new(x0, leaf, z), Vec3::new(x1, leaf + 0.08, z + 0.08), "-y+y+z", TILE);
    let wood = out.of(plan.palette.doors[paint]);
    let middle = opening.middle();
    for [left, right] in [[x0, middle - 0.006], [middle + 0.006, x1]] {
        wood.block([left, right], [y0 - 0.04, leaf], [z, z + 0.05], 1.2);
        for [low, high] in [[0.12, 0.36], [0.42, 0.92]].into_iter().filter(|_| plan.detail.shows(0.35)) {
            let at = |t: f32| y0 + (leaf - y0) * t;
            wood.block([left + 0.1, right - 0.1], [at(low), at(high)], [z + 0.05, z + 0.075], 1.2);
        }
    }
    if plan.detail.shows(0.3) {
        let steel = out.of(plan.palette.steel);
        steel.block([middle + 0.06, middle + 0.10], [y0 + 1.0, y0 + 1.16], [z + 0.05, z + 0.11], TILE);
    }
    let wall = front.z;
    let stone = out.of(plan.palette.limestone);
    for x in [x0 - 0.28, x1] {
        stone.cuboid(Vec3::new(x, BELOW, wall), Vec3::new(x + 0.28, y1, wall + 0.10), "-x+x+z", TILE);
    }
    stone.block([x0 - 0.28, x1 + 0.28], [y1, y1 + 0.26], [wall, wall + 0.11], TILE);
    if !plan.detail.shows(0.06) {
        return;
    }
    stone.block([x0 - 0.38, x1 + 0.38], [y1 + 0.26, y1 + 0.36], [wall, wall + 0.30], TILE);
}

/// A course of stone along the foot of a front, between its doors.
pub fn plinth(out: &mut Meshes, house: &House, front: &Front, openings: &[Opening], plan: &Plan) {
    let stone = out.of(plan.palette.limestone);
    // At corners the plinth of the main front goes on over the other one's end.
    let beyond = front.open.map(|open| if open || !front.main { 0.0 } else { 0.05 });
    let mut from = -beyond[0];
    let end = front.width + beyond[1];
    let doors = openings.iter().filter(|opening| opening.door).map(|opening| [opening.x[0] - 0.28, opening.x[1] + 0.28]);
    for [until, next] in doors.chain([[end, end]]) {
        let top = 0.62 + 0.001 * (house.number % 7) as f32;
        stone.divided_cuboid(Vec3::new(from, BELOW, front.z), Vec3::new(until, top, front.z + 0.05), "-x+x+y+z", plan.cell(), TILE);
        from = next;
    }
}
