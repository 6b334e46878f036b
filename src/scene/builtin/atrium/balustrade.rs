//! Pedestals, handrails and balusters between the upper columns.

use super::{PITCH, Part, Plan, RAIL, UPPER, all_bays, all_columns};
use crate::scene::builder::Mesh;
use crate::scene::builtin::profile::Profile;
use glam::{Affine3A, Vec3};

const TILE: f32 = 1.5;
/// Half the width of a pedestal.
const PEDESTAL: f32 = 0.24;

pub fn parts(plan: &Plan) -> Vec<Part> {
    let mut pedestal = Mesh::default();
    let mut band = |out: f32, from: f32, to: f32, faces: &str| {
        let half = PEDESTAL - 0.03 + out;
        pedestal.cuboid(Vec3::new(-half, UPPER + from, -half), Vec3::new(half, UPPER + to, half), faces, TILE);
    };
    if plan.detail.shows(0.1) {
        band(0.03, 0.0, 0.14, "-x+x+y-z+z");
    }
    band(0.0, 0.0, 0.83, "-x+x-z+z");
    band(0.03, 0.82, RAIL - UPPER, "-x+x-y+y-z+z");
    vec![Part::merged(&pedestal, plan.palette.stone, &all_columns()), Part::at(bay(plan), plan.palette.stone, all_bays())]
}

/// The rails and balusters of one bay, between its pedestals.
fn bay(plan: &Plan) -> Mesh {
    // The ends reach a little into the pedestals, whose plain middles stand back; in the corners the piers are wider.
    let end = PITCH / 2.0 - PEDESTAL + 0.04;
    let mut mesh = Mesh::default();
    let mut rail = |half: f32, from: f32, to: f32, faces: &str| {
        mesh.cuboid(Vec3::new(-end, UPPER + from, -half), Vec3::new(end, UPPER + to, half), faces, TILE);
    };
    rail(0.13, 0.0, 0.10, "+y-z+z");
    if plan.detail.shows(0.14) {
        rail(0.115, 0.80, 0.85, "-y-z+z");
    }
    rail(0.155, 0.845, RAIL - UPPER - 0.012, "-y+y-z+z");

    let (foot, head) = (UPPER + 0.10, UPPER + 0.80);
    let profile = Profile::from(0.062, foot + 0.05)
        .line(0.062, foot + 0.075)
        .curve((0.03, foot + 0.085), (0.036, foot + 0.13), 2.0)
        .curve((0.09, foot + 0.23), (0.072, foot + 0.31), 3.0)
        .curve((0.058, foot + 0.42), (0.034, foot + 0.53), 4.0)
        .torus(0.014, foot + 0.56, 1.0)
        .curve((0.034, foot + 0.60), (0.058, foot + 0.64), 2.0);
    let sides = plan.detail.count(12.0, 4);
    let mut baluster = Mesh::default();
    baluster.lathe(&profile, sides, plan.detail, TILE);
    if plan.detail.shows(0.55) {
        for (half, from, to) in [(0.066, foot, foot + 0.05), (0.062, foot + 0.64, head)] {
            baluster.cuboid(Vec3::new(-half, from, -half), Vec3::new(half, to, half), "-x+x-y+y-z+z", TILE);
        }
    }
    let count = (32.0 * plan.detail.0).clamp(3.0, 8.0) as usize;
    for i in 0..count {
        let x = end * (2.0 * (i as f32 + 0.5) / count as f32 - 1.0) * 0.98;
        mesh.append(&baluster, Affine3A::from_translation(Vec3::X * x));
    }
    mesh
}
