//! Tables with chairs under parasols, before shops without awnings.

use super::{FRONT, KERB, Plan, place};
use crate::scene::builder::Mesh;
use crate::scene::builtin::parts::Part;
use crate::scene::builtin::profile::Profile;
use glam::{Affine3A, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};

/// Places along the street, sides of it, and stripes of the parasols.
const TABLES: [(f32, f32, usize); 8] = [
    (-21.2, -1.0, 3),
    (-18.0, -1.0, 3),
    (31.4, -1.0, 0),
    (34.6, -1.0, 0),
    (-25.0, 1.0, 2),
    (-22.0, 1.0, 2),
    (-19.0, 1.0, 2),
    (12.5, 1.0, 1),
];

pub fn parts(plan: &Plan) -> Vec<Part> {
    let palette = &plan.palette;
    let places = TABLES.map(|(x, side, stripes)| (place(x, KERB, side * (FRONT - 1.12), 0.2 * x), palette.awnings[stripes]));
    let transforms = places.map(|(transform, _)| transform);
    let chairs: Vec<Affine3A> = transforms
        .iter()
        .flat_map(|table| {
            [0.1, FRAC_PI_2, PI - 0.15].map(|turn| *table * Affine3A::from_rotation_y(turn) * Affine3A::from_translation(Vec3::X * 0.66))
        })
        .collect();
    let sides = plan.detail.count(16.0, 5);
    let mut cloth = Mesh::default();
    let profile = Profile::from(1.06, 2.10).line(1.08, 2.26).curve((0.5, 2.42), (0.0, 2.66), 4.0);
    cloth.lathe(&profile, sides, plan.detail, 2.0);
    let mut pole = Mesh::default();
    let foot = Profile::from(0.26, -0.02).line(0.26, 0.05).line(0.03, 0.09).line(0.022, 2.6).line(0.0, 2.7);
    pole.lathe(&foot, sides.div_ceil(2).max(4), plan.detail, 1.0);
    let mut top = Mesh::default();
    let disc = Profile::from(0.03, 0.70).line(0.40, 0.715).curve((0.42, 0.73), (0.40, 0.745), 2.0).line(0.03, 0.745);
    top.lathe(&disc, sides, plan.detail, 1.0);
    let (seat, frame) = if plan.detail.shows(0.11) { chair(plan) } else { Default::default() };
    vec![
        Part::painted(cloth, &places),
        Part::merged(&pole, palette.steel, &transforms),
        Part::merged(&top, palette.limestone, &transforms),
        Part::merged(&seat, palette.timber, &chairs),
        Part::merged(&frame, palette.iron, &chairs),
    ]
}

/// A chair that faces -x: its seat and back, and its legs.
fn chair(plan: &Plan) -> (Mesh, Mesh) {
    let (mut seat, mut frame) = (Mesh::default(), Mesh::default());
    let solid = |mesh: &mut Mesh, min: [f32; 3], max: [f32; 3]| mesh.solid(min.into(), max.into(), f32::INFINITY, 1.0);
    solid(&mut seat, [-0.2, 0.43, -0.2], [0.2, 0.46, 0.2]);
    if plan.detail.shows(0.35) {
        for y in [0.62, 0.74] {
            solid(&mut seat, [0.185, y, -0.2], [0.205, y + 0.08, 0.2]);
        }
    } else {
        solid(&mut seat, [0.185, 0.62, -0.2], [0.205, 0.82, 0.2]);
    }
    for z in [-0.18, 0.18] {
        solid(&mut frame, [0.17, -0.01, z - 0.012], [0.194, 0.84, z + 0.012]);
        solid(&mut frame, [-0.19, -0.01, z - 0.012], [-0.166, 0.44, z + 0.012]);
    }
    (seat, frame)
}
