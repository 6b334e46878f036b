//! What stands on the pavements: lamps, bollards, benches, bins and advertising columns.

use super::shops::rod;
use super::{FRONT, HALF, KERB, Plan, ROAD, WALK, place};
use crate::scene::builder::Mesh;
use crate::scene::builtin::parts::Part;
use crate::scene::builtin::profile::Profile;
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI, TAU};

pub fn parts(plan: &Plan) -> Vec<Part> {
    let palette = &plan.palette;
    let line = ROAD + 0.5;
    let mut parts = Vec::new();

    let spots = [-38.0, -18.0, 0.0, 20.0, 39.0].map(|x| place(x, KERB, -line, -FRAC_PI_2));
    let others = [-42.0, -24.0, -6.0, 9.0, 24.0, 42.0].map(|x| place(x, KERB, line, FRAC_PI_2));
    let lamps: Vec<Affine3A> = spots.into_iter().chain(others).collect();
    let (post, lantern) = lamp(plan);
    parts.push(Part::at(post, palette.iron, lamps.clone()));
    parts.push(Part::at(lantern, palette.lamp_glass, lamps));

    // Bollards around the corners of the pavements.
    let mut bollards = Vec::new();
    for hand in [-1.0, 1.0] {
        for side in [-1.0, 1.0] {
            for i in 0..5 {
                let (sin, cos) = (FRAC_PI_2 * i as f32 / 4.0).sin_cos();
                let corner = Vec2::new(HALF + WALK - 2.5, ROAD + 2.5) + 2.15 * Vec2::new(cos, -sin);
                bollards.push(place(hand * corner.x, KERB, side * corner.y, 0.0));
            }
            bollards.extend([46.0, 44.4, 42.8].map(|x| place(hand * x, KERB, side * (ROAD + 0.4), 0.0)));
        }
    }
    if plan.detail.shows(0.1) {
        parts.push(Part::merged(&bollard(plan), palette.iron, &bollards));
    }

    let benches: Vec<Affine3A> =
        [(-30.2, -1.0), (-12.2, -1.0), (12.4, -1.0), (33.4, -1.0), (-36.2, 1.0), (-11.8, 1.0), (6.2, 1.0), (36.2, 1.0)]
            .map(|(x, side)| place(x, KERB, side * (ROAD + 0.95), if side > 0.0 { 0.0 } else { PI }))
            .to_vec();
    let (slats, frame) = if plan.detail.shows(0.09) { bench(plan) } else { Default::default() };
    parts.push(Part::merged(&slats, palette.timber, &benches));
    parts.push(Part::merged(&frame, palette.iron, &benches));

    let bins = [(-28.4, -1.0), (-14.1, -1.0), (10.6, -1.0), (-34.4, 1.0), (-13.3, 1.0), (8.1, 1.0), (34.6, 1.0)]
        .map(|(x, side)| place(x, KERB, side * (ROAD + 0.6), 0.0));
    parts.push(Part::merged(&bin(plan), palette.shutters[0], &bins));

    let columns = [(-21.0, 1.0), (39.0, 1.0), (-40.6, -1.0), (24.0, -1.0)].map(|(x, side)| place(x, KERB, side * (ROAD + 1.05), x));
    let (drum, cap) = column(plan);
    parts.push(Part::merged(&drum, palette.posters, &columns));
    parts.push(Part::merged(&cap, palette.shutters[0], &columns));

    // Tubs with clipped shrubs before the doors on both sides.
    let tubs: Vec<Affine3A> = [(-47.0, 1.0), (-3.4, 1.0), (18.0, 1.0), (-52.0, -1.0), (-20.0, -1.0), (12.0, -1.0), (29.5, -1.0)]
        .map(|(x, side)| place(x, KERB, side * (FRONT - 0.62), 0.0))
        .to_vec();
    let (tub, shrub) = tub(plan);
    parts.push(Part::merged(&tub, palette.pots, &tubs));
    parts.push(Part::at(shrub, palette.leaves, tubs));
    parts
}

/// A lamp: a post with a foot and an arm over the road, which is its +x; and its lantern.
fn lamp(plan: &Plan) -> (Mesh, Mesh) {
    let sides = plan.detail.count(14.0, 4);
    let mut post = Mesh::default();
    let profile = Profile::from(0.17, -0.02)
        .line(0.17, 0.10)
        .curve((0.12, 0.14), (0.12, 0.30), 3.0)
        .line(0.12, 0.62)
        .torus(0.025, 0.72, 3.0)
        .curve((0.065, 0.80), (0.062, 1.1), 3.0)
        .line(0.052, 2.6)
        .torus(0.025, 2.68, 3.0)
        .line(0.048, 2.68)
        .line(0.040, 5.0)
        .torus(0.02, 5.06, 3.0)
        .line(0.0, 5.16);
    post.lathe(&profile, sides, plan.detail, 1.0);
    // The arm is a quarter of an ellipse.
    let turns = plan.detail.count(10.0, 3);
    let around = plan.detail.count(8.0, 3);
    let spine = |u: f32| {
        let (sin, cos) = (FRAC_PI_2 * u).sin_cos();
        (Vec3::new(1.1 * (1.0 - cos), 4.75 + 0.55 * sin, 0.0), Vec3::new(-0.55 * cos, 1.1 * sin, 0.0).normalize())
    };
    post.patch(turns, around, |u, v| {
        // The arm rises from the post and ends level.
        let (at, out) = spine(u);
        let (sin, cos) = if v == 1.0 { (0.0, 1.0) } else { (TAU * v).sin_cos() };
        let normal = out * cos + Vec3::Z * sin;
        (at + normal * 0.028, normal, Vec2::new(u, v))
    });
    rod(&mut post, Vec3::new(0.03, 4.2, 0.0), Vec3::new(0.66, 5.25, 0.0), 0.014);
    // The lantern's cap hangs under the arm's end.
    let mut cap = Mesh::default();
    let profile = Profile::from(0.21, -0.22).line(0.22, -0.18).curve((0.20, -0.08), (0.06, -0.02), 4.0).line(0.03, 0.05).line(0.0, 0.06);
    cap.lathe(&profile, sides, plan.detail, 1.0);
    cap.lathe(&Profile::from(0.0, -0.215).line(0.215, -0.215), sides, plan.detail, 1.0);
    let hung = Affine3A::from_translation(Vec3::new(1.1, 5.27, 0.0));
    post.append(&cap, hung);
    let mut glass = Mesh::default();
    let profile = Profile::from(0.0, -0.44).curve((0.13, -0.43), (0.15, -0.32), 4.0).line(0.17, -0.20);
    glass.lathe(&profile, sides, plan.detail, 1.0);
    let mut lantern = Mesh::default();
    lantern.append(&glass, hung);
    (post, lantern)
}

fn bollard(plan: &Plan) -> Mesh {
    let mut mesh = Mesh::default();
    let profile = Profile::from(0.09, -0.02)
        .line(0.09, 0.06)
        .curve((0.06, 0.09), (0.06, 0.16), 2.0)
        .line(0.05, 0.74)
        .torus(0.02, 0.80, 2.0)
        .curve((0.075, 0.84), (0.06, 0.90), 3.0)
        .curve((0.045, 0.95), (0.0, 0.95), 3.0);
    mesh.lathe(&profile, plan.detail.count(12.0, 4), plan.detail, 0.5);
    mesh
}

/// A bench that faces -z, 1.7 m long: its slats and its frame.
fn bench(plan: &Plan) -> (Mesh, Mesh) {
    let (mut slats, mut frame) = (Mesh::default(), Mesh::default());
    let slat = |mesh: &mut Mesh, y: f32, z: f32, tall: f32, deep: f32| {
        mesh.solid(Vec3::new(-0.85, y, z), Vec3::new(0.85, y + tall, z + deep), f32::INFINITY, 1.0);
    };
    if plan.detail.shows(0.25) {
        for i in 0..4 {
            slat(&mut slats, 0.43, -0.24 + 0.115 * i as f32, 0.03, 0.095);
        }
        for i in 0..3 {
            slat(&mut slats, 0.54 + 0.125 * i as f32, 0.225 + 0.02 * i as f32, 0.10, 0.03);
        }
    } else {
        slat(&mut slats, 0.43, -0.24, 0.03, 0.46);
        slat(&mut slats, 0.54, 0.225, 0.36, 0.03);
    }
    for x in [-0.66, 0.66] {
        for (min, max) in [
            ([x - 0.03, -0.02, -0.20], [x + 0.03, 0.43, -0.15]),
            ([x - 0.03, -0.02, 0.26], [x + 0.03, 0.88, 0.30]),
            ([x - 0.03, 0.39, -0.15], [x + 0.03, 0.43, 0.26]),
        ] {
            frame.solid(min.into(), max.into(), f32::INFINITY, 1.0);
        }
    }
    (slats, frame)
}

fn bin(plan: &Plan) -> Mesh {
    let mut mesh = Mesh::default();
    let profile = Profile::from(0.20, -0.02)
        .line(0.23, 0.05)
        .line(0.25, 0.72)
        .torus(0.02, 0.78, 2.0)
        .line(0.22, 0.78)
        .line(0.20, 0.66)
        .line(0.0, 0.66);
    mesh.lathe(&profile, plan.detail.count(16.0, 5), plan.detail, 0.5);
    mesh
}

/// An advertising column: a drum with posters, and its foot and cap.
fn column(plan: &Plan) -> (Mesh, Mesh) {
    let sides = plan.detail.count(36.0, 8);
    let (mut drum, mut cap) = (Mesh::default(), Mesh::default());
    let radius = 0.62;
    let rows = super::meshes::cells(2.3, plan.cell());
    drum.patch(sides, rows, |u, v| {
        let (sin, cos) = if u == 1.0 { (0.0, 1.0) } else { (TAU * u).sin_cos() };
        let normal = Vec3::new(cos, 0.0, -sin);
        (normal * radius + Vec3::Y * (0.3 + 2.3 * v), normal, Vec2::new(u * 1.0, 1.0 - v))
    });
    cap.lathe(&Profile::from(0.68, -0.02).line(0.68, 0.24).curve((0.66, 0.31), (0.60, 0.31), 2.0), sides, plan.detail, 1.0);
    let profile = Profile::from(0.60, 2.58)
        .line(0.70, 2.60)
        .line(0.70, 2.72)
        .curve((0.64, 2.78), (0.62, 2.80), 2.0)
        .curve((0.56, 3.10), (0.12, 3.22), 6.0)
        .curve((0.06, 3.26), (0.10, 3.36), 3.0)
        .curve((0.10, 3.46), (0.0, 3.48), 3.0);
    cap.lathe(&profile, sides, plan.detail, 1.0);
    (drum, cap)
}

/// A tub of clay, and the shrub in it.
fn tub(plan: &Plan) -> (Mesh, Mesh) {
    use crate::scene::builtin::foliage::Crown;
    use crate::scene::builtin::noise::Random;
    let mut tub = Mesh::default();
    let profile = Profile::from(0.20, -0.02)
        .line(0.22, 0.03)
        .curve((0.29, 0.25), (0.30, 0.44), 4.0)
        .torus(0.025, 0.52, 3.0)
        .line(0.26, 0.52)
        .line(0.25, 0.46)
        .line(0.0, 0.46);
    tub.lathe(&profile, plan.detail.count(20.0, 5), plan.detail, 0.7);
    let sprigs = ((160.0 * plan.detail.0.powf(0.9)) as usize).max(16);
    let size = 0.26 * (160.0 / sprigs as f32).sqrt().clamp(0.6, 2.0);
    let crown = Crown { center: Vec3::Y * 0.88, radius: 0.40, aspect: Vec3::new(1.0, 1.15, 1.0), sprigs, size };
    (tub, crown.grow(&mut Random::new(plan.seed ^ 0x5b), |sprig| super::trees::sprig_cells(plan, sprig)))
}
