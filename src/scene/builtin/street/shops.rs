//! Ground floors with shops: windows, doors, signs and awnings.

use super::Plan;
use super::facade::{Front, Opening};
use super::lots::{Base, House};
use super::meshes::Meshes;
use super::windows::quarter;
use crate::scene::builder::Mesh;
use crate::scene::builtin::noise::unit;
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

pub fn build(out: &mut Meshes, house: &House, front: &Front, openings: &[Opening], plan: &Plan) {
    let Base::Shop(sign, awning) = house.lot.base else { return };
    for opening in openings {
        window(out, opening, sign, plan);
    }
    let ground = house.lot.ground();
    let wall = front.z;
    let (left, right) = (0.22, front.width - 0.22);
    // The sign, and a moulding over it.
    let (low, high) = (ground - 0.92, ground - 0.34);
    let board = out.of(plan.palette.signs[sign]);
    board.divided_cuboid(Vec3::new(left, low, wall), Vec3::new(right, high, wall + 0.09), "-x+x-y+y+z", plan.cell(), 1.5);
    let stone = out.of(plan.palette.limestone);
    let (min, max) = (Vec3::new(left - 0.05, high, wall), Vec3::new(right + 0.05, high + 0.07, wall + 0.16));
    stone.divided_cuboid(min, max, "-x+x-y+y+z", plan.cell(), 1.5);
    if plan.detail.shows(0.45) {
        lettering(out, house, [left, right], [low, high], wall + 0.09, plan);
    }
    if let Some(stripes) = awning {
        let edge = [0.3, front.width - 0.3];
        out.of(plan.palette.awnings[stripes]).append(&sheet(house.number, edge, ground - 1.0, wall, plan), Affine3A::IDENTITY);
        if plan.detail.shows(0.3) {
            arms(out, edge, ground - 1.0, wall, plan);
        }
    }
}

/// The glass of a shop's opening with its frame, or its door.
fn window(out: &mut Meshes, opening: &Opening, sign: usize, plan: &Plan) {
    let ([x0, x1], [y0, y1], z) = (opening.x, opening.y, opening.z);
    let picture = quarter(opening.number, plan.seed);
    out.of(plan.palette.shop_glass).picture([x0 - 0.03, x1 + 0.03], [y0 - 0.05, y1 + 0.03], z, picture, plan.cell());
    let frames = if sign == 4 { out.of(plan.palette.frames) } else { out.of(plan.palette.iron) };
    if opening.door && plan.detail.shows(0.06) || plan.detail.shows(0.2) {
        let mut bar = |x: [f32; 2], y: [f32; 2], faces: &str| {
            frames.cuboid(Vec3::new(x[0], y[0], z), Vec3::new(x[1], y[1], z + 0.07), faces, 1.5);
        };
        let wide = 0.08;
        bar([x0, x0 + wide], [y0, y1], "+x+z");
        bar([x1 - wide, x1], [y0, y1], "-x+z");
        bar([x0 + wide, x1 - wide], [y1 - wide, y1], "-y+z");
        bar([x0 + wide, x1 - wide], [y0 - 0.02, y0 + wide], "+y+z");
        let panes = ((x1 - x0) / if opening.door { 0.9 } else { 1.3 }).round().max(1.0) as usize;
        for pane in 1..panes {
            let x = x0 + (x1 - x0) * pane as f32 / panes as f32;
            bar([x - 0.03, x + 0.03], [y0 + wide, y1 - wide], "-x+x+z");
        }
        let transom = y1 - 0.52;
        bar([x0 + wide, x1 - wide], [transom - 0.03, transom + 0.03], "-y+y+z");
        if opening.door {
            bar([x0 + wide, x1 - wide], [y0, y0 + 0.34], "+y+z");
        }
    }
}

/// Raised letters, as bars of a few widths.
fn lettering(out: &mut Meshes, house: &House, [left, right]: [f32; 2], [low, high]: [f32; 2], z: f32, plan: &Plan) {
    let Base::Shop(sign, _) = house.lot.base else { return };
    let letters = if sign == 4 { out.of(plan.palette.iron) } else { out.of(plan.palette.frames) };
    let count = 5 + house.number as usize % 5;
    let pitch = 0.34;
    let start = 0.5 * (left + right) - 0.5 * pitch * count as f32;
    let (foot, head) = (low + 0.14, high - 0.13);
    let middle = 0.5 * (foot + head);
    for letter in 0..count {
        let x = start + pitch * letter as f32;
        let wide = 0.22;
        let mut stroke = |x: [f32; 2], y: [f32; 2]| letters.block(x, y, [z, z + 0.03], 1.5);
        let kind = unit(letter as u32, house.number, 0x1e77);
        stroke([x, x + 0.05], [foot, head]);
        if kind < 0.7 {
            stroke([x + wide - 0.05, x + wide], [foot, head]);
        }
        if kind > 0.25 {
            stroke([x + 0.05, x + wide - 0.05], [head - 0.05, head]);
        }
        if !(0.15..0.8).contains(&kind) {
            stroke([x + 0.05, x + wide - 0.05], [middle - 0.025, middle + 0.025]);
        } else {
            stroke([x + 0.05, x + wide - 0.05], [foot, foot + 0.05]);
        }
    }
}

/// Depth and fall of the awnings, and the height of the valance.
const OUT: f32 = 1.45;
const FALL: f32 = 0.60;
const VALANCE: f32 = 0.26;

/// An awning: a sheet that falls from the wall, and a scalloped valance.
fn sheet(number: u32, [x0, x1]: [f32; 2], top: f32, wall: f32, plan: &Plan) -> Mesh {
    let mut mesh = Mesh::default();
    let width = x1 - x0;
    // A scallop for each stripe.
    let scallops = (width * 4.0).round();
    let cells = [plan.detail.count(6.0 * width, 4), plan.detail.count(14.0, 3)];
    let slope = OUT.hypot(FALL);
    let total = slope + VALANCE;
    let phase = unit(number, 7, 0xa3) * TAU;
    let shape = |u: f32, v: f32| {
        let along = v * total;
        let x = x0 + width * u;
        let t = (along / slope).min(1.0);
        let sag = 0.045 * (PI * t).sin() * (1.0 + 0.25 * (3.0 * x + phase).sin());
        let drop = (along - slope).max(0.0);
        let scallop = 0.75 + 0.25 * (PI * scallops * u).sin().abs();
        let flutter = 0.02 * (drop / VALANCE) * (2.3 * x + phase).sin();
        Vec3::new(x, top - FALL * t - sag - drop * scallop, wall + 0.03 + OUT * t + flutter)
    };
    mesh.surface(cells, true, shape, |u, v| Vec2::new(scallops * u / 8.0, v * total / 2.0));
    mesh
}

/// The awning's roller on the wall, and the arms and the bar that hold its edge.
fn arms(out: &mut Meshes, [x0, x1]: [f32; 2], top: f32, wall: f32, plan: &Plan) {
    let steel = out.of(plan.palette.steel);
    steel.divided_cuboid(Vec3::new(x0, top - 0.03, wall), Vec3::new(x1, top + 0.07, wall + 0.10), "-x+x-y+y+z", plan.cell(), 1.5);
    let edge = Vec3::new(0.0, top - FALL - 0.03, wall + OUT);
    steel.solid(Vec3::new(x0 + 0.02, edge.y - 0.02, edge.z - 0.03), Vec3::new(x1 - 0.02, edge.y + 0.015, edge.z + 0.005), plan.cell(), 1.5);
    for x in [x0 + 0.05, x1 - 0.05] {
        let (from, to) = (Vec3::new(x, top - FALL - 0.35, wall), Vec3::new(x, edge.y - 0.01, edge.z - 0.02));
        rod(steel, from, to, 0.014);
    }
}

/// A square rod between two points.
pub fn rod(mesh: &mut Mesh, from: Vec3, to: Vec3, half: f32) {
    let along = (to - from).normalize();
    let right = along.cross(if along.y.abs() > 0.9 { Vec3::X } else { Vec3::Y }).normalize();
    let up = right.cross(along);
    for (side, other) in [(right, up), (up, right), (-right, up), (-up, right)] {
        mesh.patch(1, 1, |u, v| {
            let across = other * (half * (2.0 * v - 1.0));
            (from.lerp(to, u) + side * half + across, side, Vec2::new(u, v))
        });
    }
}
