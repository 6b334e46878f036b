//! Orange trees in terracotta pots, and agaves in urns.

use super::{HALF, PITCH, PLINTH, Part, Plan};
use crate::scene::builder::Mesh;
use crate::scene::builtin::foliage::{Crown, direction};
use crate::scene::builtin::noise::Random;
use crate::scene::builtin::place;
use crate::scene::builtin::profile::Profile;
use glam::{Affine3A, Vec2, Vec3};

pub fn parts(plan: &Plan) -> Vec<Part> {
    let palette = &plan.palette;
    let mut trees = Vec::new();
    for (x, z, turn) in [(-4.5, -2.1, 0.3), (-4.5, 2.1, 2.1), (4.5, -2.1, 4.4), (4.5, 2.1, 1.2), (8.6, 2.75, 3.3), (8.6, -2.75, 5.1)] {
        trees.push(place(x, 0.0, z, turn));
    }
    let mut agaves = Vec::new();
    for (i, x) in [-PITCH * 3.0, -PITCH, PITCH, PITCH * 3.0].into_iter().enumerate() {
        for hand in [-1.0, 1.0] {
            agaves.push(place(x, 0.0, hand * (HALF[1] - 0.95), i as f32 * 1.9 + hand));
        }
    }
    for z in [-PITCH / 2.0, PITCH / 2.0] {
        for hand in [-1.0, 1.0] {
            agaves.push(Affine3A::from_translation(Vec3::new(hand * (HALF[0] + 2.9), PLINTH, z)));
        }
    }
    let (pot, soil) = pot(plan);
    let (urn, earth) = urn(plan);
    let (trunk, crown, fruit) = orange_tree(plan);
    vec![
        Part::at(pot, palette.terracotta, trees.clone()),
        Part::merged(&soil, palette.soil, &trees),
        Part::merged(&trunk, palette.bark, &trees),
        Part::at(crown, palette.leaves, trees.clone()),
        Part::at(fruit, palette.orange, trees),
        Part::at(urn, palette.terracotta, agaves.clone()),
        Part::merged(&earth, palette.soil, &agaves),
        Part::at(agave(plan), palette.agave, agaves),
    ]
}

fn pot(plan: &Plan) -> (Mesh, Mesh) {
    let profile = Profile::from(0.24, 0.0)
        .line(0.25, 0.03)
        .curve((0.33, 0.25), (0.345, 0.48), 6.0)
        .line(0.37, 0.49)
        .torus(0.025, 0.57, 4.0)
        .line(0.33, 0.57)
        .line(0.325, 0.50);
    turned(&profile, 0.33, 0.515, plan)
}

fn urn(plan: &Plan) -> (Mesh, Mesh) {
    let profile = Profile::from(0.17, 0.0)
        .line(0.17, 0.04)
        .curve((0.09, 0.08), (0.09, 0.14), 3.0)
        .torus(0.02, 0.17, 2.0)
        .curve((0.30, 0.22), (0.28, 0.40), 6.0)
        .curve((0.26, 0.50), (0.21, 0.52), 4.0)
        .curve((0.22, 0.56), (0.28, 0.58), 3.0)
        .torus(0.015, 0.61, 3.0)
        .line(0.24, 0.61)
        .line(0.22, 0.56);
    turned(&profile, 0.235, 0.575, plan)
}

/// A vessel of revolution, and the earth in it.
fn turned(profile: &Profile, radius: f32, height: f32, plan: &Plan) -> (Mesh, Mesh) {
    let sides = plan.detail.count(28.0, 5);
    let (mut vessel, mut earth) = (Mesh::default(), Mesh::default());
    vessel.lathe(profile, sides, plan.detail, 0.7);
    let disc = Profile::from(radius, height).line(0.0, height + 0.03);
    earth.lathe(&disc, sides, plan.detail, 0.5);
    (vessel, earth)
}

/// An orange tree: trunk, sprigs of leaves all over a ball, and oranges among them.
fn orange_tree(plan: &Plan) -> (Mesh, Mesh, Mesh) {
    let mut random = Random::new(plan.seed ^ 0x0a12);
    let (mut trunk, mut fruit) = (Mesh::default(), Mesh::default());
    let bark = Profile::from(0.045, 0.5).curve((0.025, 0.7), (0.03, 1.0), 4.0).curve((0.035, 1.3), (0.02, 1.75), 4.0);
    trunk.lathe(&bark, plan.detail.count(10.0, 3), plan.detail, 0.5);
    let center = Vec3::new(0.0, 1.78, 0.0);
    let sprigs = ((520.0 * plan.detail.0.powf(0.8)) as usize).max(24);
    let cells = plan.detail.count(1.6, 1);
    let cells = if plan.detail.shows(0.25) { [cells * 2, cells] } else { [1, 1] };
    // Sprigs are larger if they are fewer, so that the crown stays closed.
    let size = 0.25 * (520.0 / sprigs as f32).sqrt().clamp(0.75, 2.6);
    let crown = Crown { center, radius: 0.56, aspect: Vec3::new(1.0, 0.94, 1.0), sprigs, size }.grow(&mut random, |_| cells);
    let ball = Profile::from(0.0, -0.042).curve((0.042, -0.042), (0.042, 0.0), 4.0).curve((0.042, 0.042), (0.0, 0.042), 4.0);
    for i in 0..26 {
        let out = direction(i, 26, &mut random);
        let mut orange = Mesh::default();
        orange.lathe(&ball, plan.detail.count(10.0, 4), plan.detail, 0.3);
        fruit.append(&orange, Affine3A::from_translation(center + out * random.range(0.48, 0.55)));
    }
    (trunk, crown, fruit)
}

/// A rosette of thick pointed leaves that bend outwards.
fn agave(plan: &Plan) -> Mesh {
    let mut random = Random::new(plan.seed ^ 0xa6a7);
    let mut mesh = Mesh::default();
    let leaves = (64.0 * plan.detail.0).clamp(8.0, 22.0) as usize;
    let cells = [plan.detail.count(4.0, 1), plan.detail.count(9.0, 2)];
    for i in 0..leaves {
        let t = i as f32 / leaves as f32;
        let turn = i as f32 * 2.399_963 + random.range(-0.15, 0.15);
        let length = (0.75 - 0.25 * t) * random.range(0.85, 1.1);
        let rise = 0.25 + 1.05 * t;
        let shape = |u: f32, v: f32| {
            let side = 2.0 * u - 1.0;
            let width = 0.055 * (1.0 - v.powi(3)) * (0.55 + 1.2 * v * (1.0 - v)) * (1.0 + 0.3 * t);
            let angle = rise - 0.75 * v * v * (1.0 - 0.6 * t);
            let (sin, cos) = angle.sin_cos();
            // A channel along the middle keeps the leaf stiff.
            let fold = width * 0.55 * side * side;
            let along = length * v;
            Vec3::new(0.03 + along * cos - fold * sin, 0.59 + along * sin + fold * cos, width * side)
        };
        let mut leaf = Mesh::default();
        leaf.surface(cells, true, shape, |u, v| Vec2::new(u, 1.0 - v));
        mesh.append(&leaf, Affine3A::from_rotation_y(turn));
    }
    mesh
}
