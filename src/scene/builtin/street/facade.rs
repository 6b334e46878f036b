//! Fronts of houses: walls with the openings of doors and windows, string courses, cornices and parapets.

use super::houses::{BELOW, PARAPET};
use super::lots::{Base, Dress, House, Wall};
use super::meshes::{Close, Meshes};
use super::{KERB, Plan, panels, shops, windows};
use crate::scene::builtin::profile::Profile;
use glam::Vec3;

/// Thickness of a parapet, and how far its coping stands out.
pub const THICK: f32 = 0.36;
pub const COPING: f32 = 0.06;
/// Side of the walls' textures, m.
const TILE: f32 = 3.0;
/// Side of a brick texture, m.
const BRICKS: f32 = 1.92;

/// A front to be built, in its own frame: x along it, the wall's face at `z`.
pub struct Front {
    pub width: f32,
    pub bays: usize,
    pub z: f32,
    /// Whether it has the house's door and shop.
    pub main: bool,
    pub parapet: bool,
    /// How mouldings end on the left and on the right.
    pub ends: [Close; 2],
    /// Whether the parapet's ends are seen.
    pub open: [bool; 2],
    /// How far the wall goes on behind its neighbours.
    pub reach: [f32; 2],
    /// Ends of the parapet's coping.
    pub coping: [f32; 2],
}

/// An opening in a wall.
#[derive(Debug, Clone, Copy)]
pub struct Opening {
    pub x: [f32; 2],
    pub y: [f32; 2],
    /// Place of the glass or the door in it.
    pub z: f32,
    pub door: bool,
    /// Of its own among all of the house.
    pub number: u32,
}

impl Opening {
    pub fn middle(&self) -> f32 {
        0.5 * (self.x[0] + self.x[1])
    }
}

/// Side of a wall's texture, m.
pub fn tile(wall: Wall) -> f32 {
    if matches!(wall, Wall::RedBrick | Wall::YellowBrick) { BRICKS } else { TILE }
}

pub fn build(out: &mut Meshes, house: &House, front: &Front, plan: &Plan) {
    ground_floor(out, house, front, plan);
    upper_floors(out, house, front, plan);
    mouldings(out, house, front, plan);
    if front.parapet {
        parapet(out, house, front, plan);
    }
}

/// Lines along a wall: its ends, and the sides of its openings.
fn lines(front: &Front, openings: impl Iterator<Item = [f32; 2]>) -> Vec<f32> {
    let mut xs = vec![-front.reach[0]];
    xs.extend(openings.flatten());
    xs.push(front.width + front.reach[1]);
    xs
}

fn ground_floor(out: &mut Meshes, house: &House, front: &Front, plan: &Plan) {
    let lot = &house.lot;
    let pitch = front.width / front.bays as f32;
    let ground = lot.ground();
    let shop = front.main && matches!(lot.base, Base::Shop(..));
    let (low, head, depth) = if shop { (0.62, ground - 1.08, recess(0.32, plan)) } else { (1.15, ground - 0.8, recess(0.2, plan)) };
    let door_bay = match (front.main, shop) {
        (false, _) => None,
        (true, true) => Some(house.number as usize % front.bays),
        (true, false) => Some(front.bays / 2),
    };
    let openings: Vec<Opening> = (0..front.bays)
        .map(|bay| {
            let door = door_bay == Some(bay);
            let half = match (shop, door) {
                (true, true) => (0.5 * pitch - 0.34).min(0.8),
                (true, false) => 0.5 * pitch - 0.34,
                (false, true) => 0.66,
                (false, false) => half_width(pitch, lot.dress),
            };
            let middle = (bay as f32 + 0.5) * pitch;
            Opening {
                x: [middle - half, middle + half],
                y: [if door { KERB } else { low }, head],
                z: front.z - depth,
                door,
                number: house.number * 256 + bay as u32 + if front.main { 0 } else { 128 },
            }
        })
        .collect();
    let xs = lines(front, openings.iter().map(|opening| opening.x));
    let ys = [BELOW, KERB, low, head, ground];
    let hole = |i: usize, j: usize| i % 2 == 1 && (j == 2 || j == 1 && openings[i / 2].door);
    pierced(out, lot.walls[0], [&xs, &ys], front, depth, plan, hole);
    if shop {
        shops::build(out, house, front, &openings, plan);
    } else {
        windows::plinth(out, house, front, &openings, plan);
        for opening in &openings {
            if opening.door {
                windows::door(out, house, front, opening, plan);
            } else {
                windows::window(out, opening, plan);
                windows::sill(out, opening, front.z, plan);
                if lot.dress != Dress::Plain && plan.detail.shows(0.16) {
                    windows::bands(out, opening, front.z, plan);
                }
            }
        }
    }
}

/// How far windows stand back: `depth` into the wall. Where there are too few triangles for holes in it, they hang before it.
fn recess(depth: f32, plan: &Plan) -> f32 {
    if plan.detail.shows(0.1) { depth } else { -0.012 }
}

/// A wall with these openings in it, or a bare one where they hang before it.
fn pierced(
    out: &mut Meshes,
    wall: Wall,
    [xs, ys]: [&[f32]; 2],
    front: &Front,
    depth: f32,
    plan: &Plan,
    hole: impl Fn(usize, usize) -> bool,
) {
    let mesh = out.of(plan.palette.walls[wall as usize]);
    if depth > 0.0 {
        mesh.wall([xs, ys], front.z, plan.cell(), tile(wall), &hole);
        mesh.reveals([xs, ys], front.z, depth, plan.cell(), tile(wall), &hole);
    } else {
        let ends = |lines: &[f32]| [lines[0], lines[lines.len() - 1]];
        mesh.wall([&ends(xs), &ends(ys)], front.z, plan.cell(), tile(wall), |_, _| false);
    }
}

/// Half the width of a window.
fn half_width(pitch: f32, dress: Dress) -> f32 {
    if matches!(dress, Dress::Shutters(_)) { (0.235 * pitch).min(0.56) } else { (0.29 * pitch).min(0.62) }
}

fn upper_floors(out: &mut Meshes, house: &House, front: &Front, plan: &Plan) {
    let lot = &house.lot;
    let top = house.eaves() + if front.parapet { PARAPET } else { 0.0 };
    let [_, wall] = lot.walls;
    let dress = match lot.dress {
        Dress::Hoarding(_) if !front.main => Dress::Plain,
        Dress::Balconies if !front.main => Dress::Bands,
        dress => dress,
    };
    if let Dress::Hoarding(color) = dress {
        let xs = lines(front, std::iter::empty());
        out.of(plan.palette.walls[wall as usize]).wall([&xs, &[lot.ground(), top]], front.z, plan.cell(), tile(wall), |_, _| false);
        panels::hoarding(out, house, front, color, plan);
        return;
    }
    let pitch = front.width / front.bays as f32;
    let half = half_width(pitch, dress);
    let depth = recess(0.2, plan);
    let openings: Vec<Opening> = (1..lot.storeys)
        .flat_map(|storey| (0..front.bays).map(move |bay| (storey, bay)))
        .map(|(storey, bay)| {
            let middle = (bay as f32 + 0.5) * pitch;
            let floor = house.floor(storey);
            let french = dress == Dress::Balconies && storey + 1 < lot.storeys;
            Opening {
                x: [middle - half, middle + half],
                y: [floor + if french { 0.14 } else { 0.85 }, floor + 2.55],
                z: front.z - depth,
                door: french,
                number: house.number * 256 + (storey * 16 + bay) as u32 + if front.main { 0 } else { 128 },
            }
        })
        .collect();
    let xs = lines(front, openings[..front.bays].iter().map(|opening| opening.x));
    let mut ys = vec![lot.ground()];
    ys.extend(openings.iter().step_by(front.bays).flat_map(|opening| opening.y));
    ys.push(top);
    let hole = |i: usize, j: usize| i % 2 == 1 && j % 2 == 1;
    pierced(out, wall, [&xs, &ys], front, depth, plan, hole);
    for opening in &openings {
        windows::window(out, opening, plan);
        if !opening.door {
            windows::sill(out, opening, front.z, plan);
        }
        match dress {
            Dress::Plain | Dress::Hoarding(_) => {}
            Dress::Shutters(paint) => windows::shutters(out, opening, front.z, paint, plan),
            Dress::Bands | Dress::Hoods | Dress::Balconies if !plan.detail.shows(0.16) => {}
            Dress::Bands => windows::bands(out, opening, front.z, plan),
            Dress::Hoods => {
                windows::bands(out, opening, front.z, plan);
                windows::hood(out, opening, front.z, plan);
            }
            Dress::Balconies => windows::bands(out, opening, front.z, plan),
        }
        if opening.door {
            windows::balcony(out, opening, front.z, plan);
        }
    }
}

/// The string course over the ground floor, and the cornice under the eaves.
fn mouldings(out: &mut Meshes, house: &House, front: &Front, plan: &Plan) {
    let stone = out.of(plan.palette.limestone);
    let along = [0.0, front.width];
    let y = house.lot.ground();
    let course = Profile::from(-0.01, y - 0.18)
        .line(0.05, y - 0.18)
        .line(0.05, y - 0.08)
        .curve((0.06, y - 0.02), (0.12, y - 0.02), 3.0)
        .line(0.13, y + 0.05)
        .line(-0.01, y + 0.09);
    stone.moulding(&course, along, front.ends, front.z, plan, 1.5);
    let y = house.eaves();
    let cornice = Profile::from(-0.01, y - 0.44)
        .line(0.05, y - 0.44)
        .torus(0.03, y - 0.37, 3.0)
        .line(0.06, y - 0.22)
        .line(0.24, y - 0.19)
        .line(0.24, y - 0.11)
        .curve((0.29, y - 0.09), (0.32, y - 0.04), 3.0)
        .line(0.38, y)
        .line(-0.01, y);
    stone.moulding(&cornice, along, front.ends, front.z, plan, 1.5);
    // Brackets under the cornice.
    if plan.detail.shows(0.55) {
        let count = (front.width / 0.62) as usize;
        for i in 0..count {
            let x = front.width * (i as f32 + 0.5) / count as f32;
            stone.block([x - 0.06, x + 0.06], [y - 0.36, y - 0.18], [front.z, front.z + 0.2], 1.5);
        }
    }
}

/// The back of the parapet, its ends, and the coping.
fn parapet(out: &mut Meshes, house: &House, front: &Front, plan: &Plan) {
    let (eaves, inner) = (house.eaves(), front.z - THICK + COPING);
    let top = eaves + PARAPET;
    let [_, wall] = house.lot.walls;
    let mesh = out.of(plan.palette.walls[wall as usize]);
    let (min, max) = (Vec3::new(0.0, eaves - 0.1, inner), Vec3::new(front.width, top, front.z));
    mesh.divided_cuboid(min, max, "-z", plan.cell(), tile(wall));
    for (open, face) in front.open.into_iter().zip(["-x", "+x"]) {
        if open {
            mesh.cuboid(min.with_y(eaves), max, face, tile(wall));
        }
    }
    let stone = out.of(plan.palette.limestone);
    let [from, to] = front.coping;
    stone.solid(Vec3::new(from, top - 0.02, front.z - THICK), Vec3::new(to, top + 0.1, front.z + COPING), plan.cell(), 1.5);
}
