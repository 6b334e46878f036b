//! Trees along the kerbs, each in a bed with an edge of stone.

use super::{KERB, Plan, ROAD, place};
use crate::scene::builder::Mesh;
use crate::scene::builtin::Detail;
use crate::scene::builtin::foliage::{Crown, direction};
use crate::scene::builtin::noise::{Random, unit};
use crate::scene::builtin::parts::Part;
use crate::scene::builtin::profile::Profile;
use glam::{Affine3A, Quat, Vec3};
use std::f32::consts::TAU;

/// Distance of the trees from the street's axis.
const LINE: f32 = ROAD + 0.95;
/// Trees on both sides: places along the street.
const SUNNY: [f32; 6] = [-48.0, -27.0, -9.0, 9.0, 30.0, 48.0];
const SHADY: [f32; 7] = [-51.0, -33.0, -15.0, 3.0, 15.0, 33.0, 51.0];

pub fn parts(plan: &Plan) -> Vec<Part> {
    let palette = &plan.palette;
    let mut random = Random::new(plan.seed ^ 0x7ee5);
    let spots = SUNNY.iter().map(|x| (*x, -LINE)).chain(SHADY.iter().map(|x| (*x, LINE)));
    let (mut beds, mut trees) = (Vec::new(), Vec::new());
    for (x, z) in spots {
        beds.push(place(x, KERB, z, 0.0));
        let (turn, size) = (random.range(0.0, TAU), random.range(0.88, 1.08));
        trees.push(Affine3A::from_scale_rotation_translation(Vec3::splat(size), Quat::from_rotation_y(turn), Vec3::new(x, KERB, z)));
    }
    let (trunk, crown) = tree(plan);
    let (edge, soil) = bed(plan);
    vec![
        Part::at(trunk, palette.bark, trees.clone()),
        Part::at(crown, palette.leaves, trees),
        Part::merged(&edge, palette.kerb, &beds),
        Part::merged(&soil, palette.soil, &beds),
    ]
}

/// A tree: a trunk that forks, and a crown of sprigs.
fn tree(plan: &Plan) -> (Mesh, Mesh) {
    let mut random = Random::new(plan.seed ^ 0x11fe);
    let mut wood = Mesh::default();
    let sides = plan.detail.count(12.0, 4);
    let bark = Profile::from(0.22, 0.0).curve((0.13, 0.15), (0.125, 0.6), 3.0).curve((0.11, 1.6), (0.10, 2.9), 4.0).line(0.06, 3.9);
    wood.lathe(&bark, sides, plan.detail, 0.6);
    let limbs = if plan.detail.shows(0.13) { 6 } else { 0 };
    for i in 0..limbs {
        let turn = TAU * (i as f32 + random.range(-0.2, 0.2)) / limbs as f32;
        let (lean, length, from) = (random.range(0.5, 0.95), random.range(1.3, 1.9), random.range(2.3, 3.1));
        let mut limb = Mesh::default();
        let profile = Profile::from(0.06, -0.05).curve((0.045, 0.5 * length), (0.018, length), 3.0).line(0.0, length + 0.02);
        limb.lathe(&profile, sides.div_ceil(2).max(3), plan.detail, 0.6);
        let turned = Quat::from_rotation_y(turn) * Quat::from_rotation_z(-lean);
        wood.append(&limb, Affine3A::from_rotation_translation(turned, Vec3::Y * from));
    }
    let sprigs = ((640.0 * plan.detail.0.powf(0.9)) as usize).max(36);
    // Sprigs are larger if they are fewer, so that the crown stays closed.
    let size = 0.62 * (640.0 / sprigs as f32).sqrt().clamp(0.6, 2.8);
    let whole = Crown { center: Vec3::Y * 4.25, radius: 1.75, aspect: Vec3::new(1.0, 1.02, 1.0), sprigs, size };
    let mut crown = whole.grow(&mut random, |sprig| sprig_cells(plan, sprig));
    // Smaller balls of leaves break the outline.
    for i in 0..5 {
        let out = direction(i, 5, &mut random);
        let part = Crown {
            center: whole.center + out * Vec3::new(1.05, 0.75, 1.05) + Vec3::Y * 0.25,
            radius: 0.95,
            aspect: Vec3::ONE,
            sprigs: sprigs / 7,
            size: size * 0.9,
        };
        crown.append(&part.grow(&mut random, |sprig| sprig_cells(plan, sprig)), Affine3A::IDENTITY);
    }
    (wood, crown)
}

/// Cells of a sprig: more for some than for others, so that the number of triangles grows in small steps.
pub fn sprig_cells(plan: &Plan, sprig: usize) -> [usize; 2] {
    let detail = Detail(plan.detail.0 * (0.6 + 0.8 * unit(sprig as u32, 1, 0x5b)));
    let cells = detail.count(0.9, 1);
    if detail.shows(0.2) { [2 * cells, cells] } else { [1, 1] }
}

/// The edge of a bed, and the soil in it.
fn bed(plan: &Plan) -> (Mesh, Mesh) {
    let (mut edge, mut soil) = (Mesh::default(), Mesh::default());
    let (half, wide, tall) = (0.68, 0.10, 0.10);
    for hand in [-1.0, 1.0] {
        let (from, to) = (hand * half, hand * (half - wide));
        edge.cuboid(Vec3::new(f32::min(from, to), -0.03, -half), Vec3::new(f32::max(from, to), tall, half), "-x+x+y-z+z", 1.5);
        edge.cuboid(Vec3::new(wide - half, -0.03, f32::min(from, to)), Vec3::new(half - wide, tall, f32::max(from, to)), "+y-z+z", 1.5);
    }
    let inner = half - wide + 0.02;
    let rows = plan.detail.count(4.0, 1);
    soil.surface(
        [rows, rows],
        false,
        |u, v| {
            let (x, z) = (inner * (2.0 * v - 1.0), inner * (2.0 * u - 1.0));
            Vec3::new(x, 0.05 + 0.05 * (1.0 - (x / inner).powi(2)) * (1.0 - (z / inner).powi(2)), z)
        },
        glam::Vec2::new,
    );
    (edge, soil)
}
