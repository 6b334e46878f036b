//! Drapes: curtains tied back between the lower columns, and banners over the balustrade.

use super::{PITCH, Part, Plan, RAIL, Side, UPPER};
use crate::scene::builder::Mesh;
use crate::scene::builtin::noise::{Random, step};
use glam::{Vec2, Vec3};
use std::f32::consts::{PI, TAU};

/// Height of the curtains' rods between the columns.
const ROD: f32 = 2.56;

pub fn parts(plan: &Plan) -> Vec<Part> {
    let palette = &plan.palette;
    let colors = [palette.cloth_red, palette.cloth_green, palette.cloth_blue];
    let banners = [palette.banner_blue, palette.banner_red, palette.banner_green];
    let (mut curtains, mut hung) = ([const { Vec::new() }; 3], [const { Vec::new() }; 3]);
    let mut rods = Vec::new();
    for (index, side) in Side::all().iter().enumerate() {
        for bay in 0..side.bays {
            let long = side.bays > 3;
            let color = (bay / 2 + index) % 3;
            if long && (bay + index / 2) % 2 == 1 {
                curtains[color].push(side.bay(bay));
                rods.push(side.bay(bay));
            }
            if (bay + index / 2) % 2 == 0 && (long || bay == 1) {
                hung[(bay / 2 + index) % 3].push(side.bay(bay));
            }
        }
    }
    let mut parts = vec![Part::at(rod(plan), palette.brass, rods)];
    for i in 0..3 {
        let seed = plan.seed.wrapping_mul(31).wrapping_add(i as u32);
        parts.push(Part::at(pair(seed, plan), colors[i], std::mem::take(&mut curtains[i])));
        parts.push(Part::at(banner(seed, plan), banners[i], std::mem::take(&mut hung[i])));
    }
    parts
}

/// A brass rod across a bay, with rings.
fn rod(plan: &Plan) -> Mesh {
    let mut mesh = Mesh::default();
    let sides = plan.detail.count(10.0, 3);
    let end = PITCH / 2.0 - 0.2;
    mesh.patch(sides, 1, |u, v| {
        let (sin, cos) = (TAU * u).sin_cos();
        let normal = Vec3::new(0.0, cos, sin);
        (normal * 0.018 + Vec3::new(end * (2.0 * v - 1.0), ROD, 0.0), normal, Vec2::new(u, v * 8.0))
    });
    mesh
}

/// The two curtains of a bay, each drawn to its column and tied there.
fn pair(seed: u32, plan: &Plan) -> Mesh {
    let mut mesh = Mesh::default();
    let cells = [plan.detail.count(84.0, 5), plan.detail.count(20.0, 3)];
    for hand in [0u32, 1] {
        let mut random = Random::new(seed ^ hand << 16);
        let phase = random.range(0.0, TAU);
        let tie = random.range(0.52, 0.58);
        // No more folds than the mesh can follow.
        let folds = (7.0 + random.range(-0.5, 0.5)).min(0.14 * cells[0] as f32);
        let mirror = if hand == 0 { 1.0 } else { -1.0 };
        let shape = |u: f32, v: f32| {
            // Full width at the rod, gathered at the tie, falling open again below.
            let above = (v / tie).clamp(0.0, 1.0);
            let width = if v < tie { 1.16 - 0.94 * above.powf(1.7) } else { 0.22 + 0.2 * step(tie, 1.0, v) };
            let gather = 1.0 - width / 1.16;
            let sag = 0.22 * (above * PI).sin() * u * u;
            let x = (1.24 - 0.03 * gather) - width * u;
            let fold = (TAU * folds * u + phase + 0.7 * (2.3 * v + phase).sin()).sin();
            let slow = (TAU * 2.0 * u + 1.7 * phase + 1.3 * v).sin();
            let depth = 0.036 - 0.022 * gather + 0.010 * v;
            let belly = 0.05 * step(0.0, 0.4, v) * (1.0 - step(tie - 0.1, tie, v));
            let z = depth * fold + 0.02 * slow * v + belly * (PI * u).sin();
            let y = ROD - 0.01 - 2.28 * v + sag * -0.5;
            Vec3::new(mirror * x, y, z)
        };
        mesh.surface(cells, hand == 1, shape, |u, v| Vec2::new(u * 2.4, v * 2.4) * 1.6);
    }
    mesh
}

/// A banner that hangs over the handrail and the string course, into the crown of the arch below.
fn banner(seed: u32, plan: &Plan) -> Mesh {
    let mut random = Random::new(seed ^ 0xba77);
    let phase = random.range(0.0, TAU);
    let width = 1.3;
    // Rail, ledge, and a free fall: (out, height), rounded where it bends.
    let path = [
        Vec2::new(-0.20, UPPER + 0.45),
        Vec2::new(-0.185, RAIL - 0.02),
        Vec2::new(-0.12, RAIL + 0.015),
        Vec2::new(0.12, RAIL + 0.015),
        Vec2::new(0.20, RAIL - 0.03),
        Vec2::new(0.50, UPPER + 0.10),
        Vec2::new(0.545, UPPER - 0.06),
        Vec2::new(0.55, UPPER - 1.35),
    ];
    let lengths: Vec<f32> = std::iter::once(0.0)
        .chain(path.windows(2).scan(0.0, |total, ends| {
            *total += ends[0].distance(ends[1]);
            Some(*total)
        }))
        .collect();
    let total = lengths[lengths.len() - 1];
    let along = |t: f32| {
        let s = t.clamp(0.0, 1.0) * total;
        let i = lengths[1..].partition_point(|&l| l < s).min(path.len() - 2);
        path[i].lerp(path[i + 1], (s - lengths[i]) / (lengths[i + 1] - lengths[i]))
    };
    let hang = |t: f32| step(0.45, 1.0, t);
    let shape = |u: f32, v: f32| {
        let p = (along(v - 0.012) + along(v) + along(v + 0.012)) / 3.0;
        let x = (u - 0.5) * width * (1.0 - 0.06 * hang(v));
        let fold = (TAU * 3.2 * u + phase).sin() * 0.03 + (TAU * 1.3 * u + 2.0 * phase + 2.0 * v).sin() * 0.025;
        Vec3::new(x, p.y - 0.015 * hang(v) * fold * 10.0, p.x + hang(v) * (fold + 0.03))
    };
    let mut mesh = Mesh::default();
    let cells = [plan.detail.count(32.0, 4), plan.detail.count(40.0, 6)];
    mesh.surface(cells, false, shape, Vec2::new);
    mesh
}
