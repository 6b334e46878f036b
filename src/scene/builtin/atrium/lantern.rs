//! Brass lanterns that hang in the galleries.

use super::{CEILING, DEPTH, Part, Plan, SPRING, Side, WALL};
use crate::scene::builder::Mesh;
use crate::scene::builtin::profile::Profile;
use glam::{Affine3A, Vec3};

pub fn parts(plan: &Plan) -> Vec<Part> {
    let mut places = Vec::new();
    let middle = -(WALL + DEPTH) / 2.0;
    for side in Side::all() {
        for bay in (0..side.bays).filter(|bay| bay % 2 == 1 || side.bays == 3 && *bay != 1) {
            for (hook, drop) in [(SPRING[0] + 1.2, 0.75), (CEILING, 0.85)] {
                places.push(side.bay(bay) * Affine3A::from_translation(Vec3::new(0.0, hook - drop, middle)));
            }
        }
    }
    let sides = plan.detail.count(12.0, 3);
    let (mut brass, mut glass) = (Mesh::default(), Mesh::default());
    // Profiles from the drip under the glass up to the ceiling.
    let foot = Profile::from(0.0, -0.30).curve((0.03, -0.29), (0.02, -0.26), 3.0).line(0.08, -0.25).line(0.10, -0.22).line(0.09, -0.20);
    let cap = Profile::from(0.16, 0.12).line(0.16, 0.14).curve((0.06, 0.18), (0.03, 0.26), 4.0).line(0.012, 0.27).line(0.01, 0.95);
    if plan.detail.shows(0.05) {
        brass.lathe(&foot, sides, plan.detail, 0.5);
    }
    brass.lathe(&cap, sides, plan.detail, 0.5);
    // A disc that closes the cap from below.
    let under = Profile::from(0.05, 0.12).line(0.16, 0.12);
    brass.lathe(&under, sides, plan.detail, 0.5);
    for i in 0..if plan.detail.shows(0.45) { 6 } else { 0 } {
        let (sin, cos) = (i as f32 * std::f32::consts::PI / 3.0).sin_cos();
        let mut bar = Mesh::default();
        bar.cuboid(Vec3::new(-0.008, -0.21, -0.008), Vec3::new(0.008, 0.125, 0.008), "-x+x-z+z", 0.5);
        brass.append(&bar, Affine3A::from_translation(Vec3::new(0.125 * cos, 0.0, 0.125 * sin)));
    }
    let pane = Profile::from(0.085, -0.21).curve((0.115, -0.05), (0.115, 0.12), 4.0);
    glass.lathe(&pane, sides, plan.detail, 0.33);
    vec![Part::merged(&brass, plan.palette.brass, &places), Part::merged(&glass, plan.palette.glass, &places)]
}
