//! The court planted: trees and shrubs of single leaves, ivy on the columns, ferns hanging in the upper gallery, tables and chairs.
//! Nearly all triangles are leaves.

use super::{BAYS, HALF, PITCH, PLINTH, Palette, Part, RAIL, Side, all_columns};
use crate::scene::Scene;
use crate::scene::builder::Mesh;
use crate::scene::builtin::Detail;
use crate::scene::builtin::foliage::direction;
use crate::scene::builtin::materials::{adder, cloth, plain};
use crate::scene::builtin::noise::Random;
use crate::scene::builtin::place;
use crate::scene::builtin::profile::Profile;
use glam::{Affine3A, Quat, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Materials that the court without a garden lacks.
#[derive(Debug, Clone, Copy)]
pub struct Greens {
    laurel: u32,
    shrub: u32,
    ivy: u32,
    fern: u32,
    rush: u32,
    china: u32,
}

impl Greens {
    /// Adds the materials to a scene.
    pub fn add(scene: &mut Scene) -> Self {
        let mut add = adder(scene);
        Self {
            laurel: add("laurel leaves", [0.15, 0.29, 0.07], None, &cloth),
            shrub: add("shrub leaves", [0.21, 0.36, 0.10], None, &cloth),
            ivy: add("ivy leaves", [0.10, 0.23, 0.07], None, &cloth),
            fern: add("fern leaves", [0.26, 0.42, 0.12], None, &cloth),
            rush: add("rush", [0.58, 0.44, 0.22], None, &plain),
            china: add("china", [0.74, 0.72, 0.68], None, &|m| m.roughness = 0.3),
        }
    }
}

/// What the garden is made from. At level 1 it has about two million triangles.
pub struct GardenPlan {
    pub detail: Detail,
    pub seed: u32,
    pub palette: Palette,
    pub greens: Greens,
}

impl GardenPlan {
    /// Number of leaves of a plant that has `full` at level 1.
    fn leaves(&self, full: f32) -> usize {
        ((full * self.detail.0 * self.detail.0) as usize).max(12)
    }

    /// Length of a leaf that is `full` long at level 1: fewer leaves are larger, so that a crown stays closed.
    fn leaf(&self, full: f32) -> f32 {
        full * self.detail.0.recip().clamp(0.5, 4.0)
    }

    /// Level of wood, pots and furniture, whose triangles grow more slowly.
    fn solid(&self) -> Detail {
        Detail(self.detail.0.sqrt().clamp(0.3, 1.6))
    }
}

pub fn parts(plan: &GardenPlan) -> Vec<Part> {
    let makers: &[fn(&GardenPlan) -> Vec<Part>] = &[trees, shrubs, ivy, ferns, furniture];
    super::parts::of_all(makers, plan)
}

/// A folded leaf of four triangles, along `lean`, with its upper side towards `up`.
fn leaf(mesh: &mut Mesh, foot: Vec3, lean: Vec3, up: Vec3, length: f32, width: f32) {
    let right = lean.cross(up).normalize_or(Vec3::X) * (0.5 * width);
    let up = right.cross(lean).normalize_or(Vec3::Y);
    let tilt = |side: f32| (up - right.normalize() * (0.5 * side)).normalize();
    let droop = up * (0.12 * length);
    let mut at = |position: Vec3, normal: Vec3, u: f32, v: f32| mesh.vertex(position, normal, Vec2::new(u, v));
    let middle = foot + lean * (0.5 * length);
    let corners = [
        at(foot, up, 0.5, 1.0),
        at(middle + right + droop * 0.6, tilt(1.0), 1.0, 0.5),
        at(middle, up, 0.5, 0.5),
        at(middle - right + droop * 0.6, tilt(-1.0), 0.0, 0.5),
        at(foot + lean * length - droop, up, 0.5, 0.0),
    ];
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [2, 1, 4], [2, 4, 3]] {
        mesh.facing([corners[a], corners[b], corners[c]]);
    }
}

/// A twig: leaves around a line that bends down.
struct Twig {
    foot: Vec3,
    along: Vec3,
    length: f32,
    leaves: usize,
    /// Length of a leaf, and its width over that.
    leaf: f32,
    slender: f32,
}

impl Twig {
    fn grow(&self, mesh: &mut Mesh, random: &mut Random) {
        let across = self.along.any_orthonormal_vector();
        for i in 0..self.leaves {
            let t = (i as f32 + random.unit()) / self.leaves as f32;
            let foot = self.foot + self.along * (self.length * t) - Vec3::Y * (0.25 * self.length * t * t);
            let out = Quat::from_axis_angle(self.along, i as f32 * 2.399_963 + random.range(-0.4, 0.4)) * across;
            let lean = (self.along * random.range(0.3, 0.9) + out + Vec3::Y * random.range(-0.35, 0.1)).normalize();
            let up = (Vec3::Y + 0.35 * out).normalize();
            let length = self.leaf * random.range(0.7, 1.15);
            leaf(mesh, foot, lean, up, length, length * self.slender);
        }
    }
}

/// A ball of twigs: leaves of a crown or a bush.
fn ball(plan: &GardenPlan, random: &mut Random, center: Vec3, radii: Vec3, leaves: usize, size: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let each = 22.min(leaves);
    let twigs = (leaves / each).max(1);
    for i in 0..twigs {
        let out = direction(i, twigs, random);
        // Most twigs are outside, some within; lobes break the outline.
        let lobes = 1.0 + 0.12 * (4.0 * out.x + 3.0 * out.y).sin() * (5.0 * out.z + 2.0 * out.y).cos();
        let depth = 1.0 - 0.55 * random.unit().powi(2);
        let foot = center + out * radii * (depth * lobes * 0.9);
        let along = (out + Vec3::new(random.range(-0.6, 0.6), random.range(-0.3, 0.5), random.range(-0.6, 0.6))).normalize();
        let twig = Twig { foot, along, length: 0.13 * radii.max_element(), leaves: each, leaf: plan.leaf(size), slender: 0.45 };
        twig.grow(&mut mesh, random);
    }
    mesh
}

/// Laurel trees in round beds, of two kinds.
fn trees(plan: &GardenPlan) -> Vec<Part> {
    let detail = plan.solid();
    let spots = [[(-8.2, -2.3, 0.4), (-0.6, 2.95, 2.2), (6.6, -2.95, 4.0)], [(-7.0, 2.9, 1.3), (2.2, -3.0, 5.2), (6.6, 3.0, 3.1)]];
    let mut parts = Vec::new();
    for (kind, spots) in spots.iter().enumerate() {
        let mut random = Random::new(plan.seed ^ (0x1a0e + kind as u32));
        let places: Vec<Affine3A> = spots.iter().map(|(x, z, turn)| place(*x, 0.0, *z, *turn)).collect();
        let (height, wide) = ([3.1, 3.6][kind], [1.85, 1.6][kind]);
        let mut wood = Mesh::default();
        let bark =
            Profile::from(0.24, 0.0).curve((0.14, 0.2), (0.13, 0.8), 4.0).curve((0.11, 1.6), (0.09, height), 6.0).line(0.05, height + 0.9);
        wood.lathe(&bark, detail.count(14.0, 4), detail, 0.6);
        let mut crown = ball(plan, &mut random, Vec3::Y * (height + 1.2), Vec3::new(wide, 1.35, wide), plan.leaves(23_000.0), 0.12);
        for i in 0..9 {
            let turn = TAU * (i as f32 + random.range(-0.25, 0.25)) / 9.0;
            let (lean, length, from) = (random.range(0.45, 1.05), random.range(1.1, 1.7), random.range(height - 1.0, height + 0.4));
            let limb = Profile::from(0.06, -0.05).curve((0.045, 0.5 * length), (0.016, length), 4.0).line(0.0, length + 0.02);
            let mut branch = Mesh::default();
            branch.lathe(&limb, detail.count(8.0, 3), detail, 0.6);
            let turned = Quat::from_rotation_y(turn) * Quat::from_rotation_z(-lean);
            wood.append(&branch, Affine3A::from_rotation_translation(turned, Vec3::Y * from));
            // A ball of leaves about the limb's end.
            let end = Vec3::Y * from + turned * Vec3::Y * length;
            let size = random.range(0.55, 0.8);
            let part = ball(plan, &mut random, end, Vec3::new(size, 0.75 * size, size), plan.leaves(1_900.0), 0.12);
            crown.append(&part, Affine3A::IDENTITY);
        }
        let kerb = Profile::from(0.85, 0.0).line(0.85, 0.28).torus(0.03, 0.34, 3.0).line(0.70, 0.34).line(0.70, 0.24);
        let (mut edge, mut soil) = (Mesh::default(), Mesh::default());
        edge.lathe(&kerb, detail.count(36.0, 8), detail, 1.5);
        soil.lathe(&Profile::from(0.72, 0.27).line(0.1, 0.30), detail.count(24.0, 8), detail, 0.5);
        parts.extend([
            Part::at(wood, plan.palette.bark, places.clone()),
            Part::at(crown, plan.greens.laurel, places.clone()),
            Part::merged(&edge, plan.palette.stone, &places),
            Part::merged(&soil, plan.palette.soil, &places),
        ]);
    }
    parts
}

/// Shrubs in pots along the columns.
fn shrubs(plan: &GardenPlan) -> Vec<Part> {
    let detail = plan.solid();
    let mut random = Random::new(plan.seed ^ 0x54b5);
    let mut places = Vec::new();
    for side in Side::all() {
        // The court's agaves stand before the others of the long sides.
        let columns = side.columns().enumerate().filter(|(i, _)| side.bays == BAYS[1] || i % 2 == 1);
        for (column, hand) in columns.flat_map(|(_, column)| [(column, -0.45), (column, 0.45)]) {
            let scale = random.range(0.8, 1.15);
            let turn = Quat::from_rotation_y(random.range(0.0, TAU));
            places.push(column * Affine3A::from_scale_rotation_translation(Vec3::splat(scale), turn, Vec3::new(hand, 0.0, 0.85)));
        }
    }
    let profile = Profile::from(0.20, 0.0)
        .line(0.21, 0.03)
        .curve((0.30, 0.2), (0.30, 0.40), 5.0)
        .torus(0.025, 0.46, 3.0)
        .line(0.27, 0.46)
        .line(0.26, 0.40);
    let (mut pot, mut soil) = (Mesh::default(), Mesh::default());
    pot.lathe(&profile, detail.count(24.0, 6), detail, 0.7);
    soil.lathe(&Profile::from(0.27, 0.42).line(0.0, 0.44), detail.count(16.0, 6), detail, 0.5);
    let leaves = ball(plan, &mut random, Vec3::Y * 0.95, Vec3::new(0.42, 0.52, 0.42), plan.leaves(5_200.0), 0.085);
    vec![
        Part::at(pot, plan.palette.terracotta, places.clone()),
        Part::merged(&soil, plan.palette.soil, &places),
        Part::at(leaves, plan.greens.shrub, places),
    ]
}

/// Ivy that winds up every second column of the lower storey.
fn ivy(plan: &GardenPlan) -> Vec<Part> {
    let mut random = Random::new(plan.seed ^ 0x1f7);
    let places: Vec<Affine3A> = all_columns().into_iter().step_by(2).collect();
    let mut mesh = Mesh::default();
    let leaves = plan.leaves(2_600.0);
    for i in 0..leaves {
        let t = (i as f32 + random.unit()) / leaves as f32;
        // Three shoots, which spread downwards.
        let shoot = random.range(0.0, 3.0).floor();
        let turn = shoot * TAU / 3.0 + 3.4 * t + random.range(-1.0, 1.0) * (0.75 - 0.5 * t);
        let (sin, cos) = turn.sin_cos();
        let out = Vec3::new(cos, 0.0, sin);
        let foot = out * (0.30 + 0.06 * random.unit()) + Vec3::Y * (PLINTH + 0.45 + 2.5 * t);
        let along = Vec3::new(-sin, 0.0, cos) * random.range(-0.8, 0.8);
        let lean = (out * random.range(0.25, 0.8) - Vec3::Y * random.range(0.3, 1.0) + along).normalize();
        let size = plan.leaf(0.085) * random.range(0.7, 1.2);
        leaf(&mut mesh, foot, lean, (out + Vec3::Y * 0.4).normalize(), size, size * 0.9);
    }
    vec![Part::at(mesh, plan.greens.ivy, places)]
}

/// Ferns in baskets that hang from the upper arches.
fn ferns(plan: &GardenPlan) -> Vec<Part> {
    let detail = plan.solid();
    let mut random = Random::new(plan.seed ^ 0xfe4);
    let mut places = Vec::new();
    for side in Side::all() {
        for bay in side.bays() {
            places.push(bay * place(0.0, RAIL + 0.75, 0.12, random.range(0.0, TAU)));
        }
    }
    let (mut basket, mut fronds) = (Mesh::default(), Mesh::default());
    let bowl = Profile::from(0.0, -0.16).curve((0.16, -0.16), (0.20, 0.0), 5.0).line(0.17, 0.0);
    basket.lathe(&bowl, detail.count(20.0, 6), detail, 0.5);
    let stem = Profile::from(0.006, 0.0).line(0.006, 2.2).line(0.0, 2.2);
    basket.lathe(&stem, 5, detail, 0.5);
    let count = 34;
    let each = (plan.leaves(3_400.0) / count).max(4);
    for i in 0..count {
        let turn = i as f32 * 2.399_963;
        let (sin, cos) = turn.sin_cos();
        let (length, rise) = (random.range(0.35, 0.62), random.range(0.3, 1.0));
        let out = Vec3::new(cos, 0.0, sin);
        // Leaflets on both sides of a stem that bends over.
        for leaflet in 0..each {
            let t = (leaflet / 2) as f32 / (each as f32 / 2.0);
            let hand = if leaflet % 2 == 0 { 1.0 } else { -1.0 };
            let foot = out * (0.05 + length * t) + Vec3::Y * (rise * length * t - 1.1 * length * t * t);
            let slope = (out + Vec3::Y * (rise - 2.2 * t)).normalize();
            let side = slope.cross(Vec3::Y).normalize_or(Vec3::X) * hand;
            let size = plan.leaf(0.075) * (1.05 - 0.8 * t);
            leaf(&mut fronds, foot, (side + 0.45 * slope).normalize(), slope.cross(side) * hand, size, size * 0.35);
        }
    }
    vec![Part::at(basket, plan.greens.rush, places.clone()), Part::at(fronds, plan.greens.fern, places)]
}

/// Laid tables with four chairs each, in the court and in the long galleries.
fn furniture(plan: &GardenPlan) -> Vec<Part> {
    let mut tables: Vec<Affine3A> =
        [(-6.3, -0.6), (-2.4, -1.7), (2.3, 1.9), (6.4, 0.7)].iter().map(|(x, z)| place(*x, 0.0, *z, 0.3 * x)).collect();
    for x in [-7.5, -1.5, 4.5, 10.5] {
        for hand in [-1.0, 1.0] {
            tables.push(place(x, PLINTH, hand * (HALF[1] + 0.6 * PITCH), 0.2 * x + hand));
        }
    }
    let seats: Vec<Affine3A> = tables
        .iter()
        .flat_map(|table| {
            (0..4).map(|i| *table * Affine3A::from_rotation_y(FRAC_PI_2 * i as f32) * Affine3A::from_translation(Vec3::Z * 0.78))
        })
        .collect();
    let (wood, seat) = chair(plan.solid());
    let (table, china) = table(plan.solid());
    vec![
        Part::at(wood, plan.palette.wood, seats.clone()),
        Part::at(seat, plan.greens.rush, seats),
        Part::at(table, plan.palette.wood, tables.clone()),
        Part::at(china, plan.greens.china, tables),
    ]
}

/// A rod of a radius, from one point to another.
fn rod(mesh: &mut Mesh, from: Vec3, to: Vec3, radius: f32, detail: Detail) {
    let length = from.distance(to);
    let profile = Profile::from(0.0, 0.0).line(radius, 0.0).curve((radius * 1.25, 0.5 * length), (radius, length), 4.0).line(0.0, length);
    let mut it = Mesh::default();
    it.lathe(&profile, detail.count(9.0, 4), detail, 0.4);
    mesh.append(&it, Affine3A::from_rotation_translation(Quat::from_rotation_arc(Vec3::Y, (to - from) / length), from));
}

/// A ladder-back chair that looks along -z: its wood, and its seat of rush.
fn chair(detail: Detail) -> (Mesh, Mesh) {
    let (mut wood, mut seat) = (Mesh::default(), Mesh::default());
    for hand in [-1.0, 1.0] {
        let (front, back) = (Vec3::new(hand * 0.20, 0.0, -0.19), Vec3::new(hand * 0.18, 0.0, 0.19));
        rod(&mut wood, front, front + Vec3::Y * 0.46, 0.017, detail);
        rod(&mut wood, back, back + Vec3::new(0.0, 1.0, 0.09), 0.017, detail);
        for height in [0.16, 0.28] {
            rod(&mut wood, front + Vec3::Y * height, back + Vec3::new(0.0, height, 0.02), 0.009, detail);
        }
    }
    for height in [0.12, 0.24] {
        rod(&mut wood, Vec3::new(-0.2, height, -0.19), Vec3::new(0.2, height, -0.19), 0.009, detail);
    }
    for height in [0.58, 0.72, 0.86] {
        // Slats that bend backwards.
        let deep = 0.19 + 0.09 * height;
        let at = |u: f32, v: f32, back: f32| Vec3::new(0.36 * u - 0.18, height + 0.07 * v - 0.035, deep + back + 0.12 * u * (1.0 - u));
        let cells = [detail.count(8.0, 2), detail.count(2.0, 1)];
        wood.surface(cells, false, |u, v| at(u, v, 0.006), Vec2::new);
        wood.surface(cells, true, |u, v| at(u, v, -0.006), Vec2::new);
    }
    seat.divided_cuboid(
        Vec3::new(-0.21, 0.43, -0.20),
        Vec3::new(0.21, 0.465, 0.20),
        "-x+x-y+y-z+z",
        0.5 / detail.count(8.0, 1) as f32,
        0.4,
    );
    (wood, seat)
}

/// A round table on four legs, and what is laid on it.
fn table(detail: Detail) -> (Mesh, Mesh) {
    let (mut wood, mut china) = (Mesh::default(), Mesh::default());
    let top = Profile::from(0.0, 0.70).line(0.50, 0.70).torus(0.012, 0.735, 3.0).line(0.0, 0.735);
    wood.lathe(&top, detail.count(40.0, 8), detail, 0.6);
    for i in 0..4 {
        let (sin, cos) = (FRAC_PI_2 * (i as f32 + 0.5)).sin_cos();
        rod(&mut wood, Vec3::new(0.40 * cos, 0.0, 0.40 * sin), Vec3::new(0.34 * cos, 0.70, 0.34 * sin), 0.024, detail);
    }
    let plate = Profile::from(0.0, 0.737).line(0.07, 0.737).curve((0.09, 0.738), (0.125, 0.758), 4.0).line(0.12, 0.760).curve(
        (0.085, 0.745),
        (0.0, 0.743),
        4.0,
    );
    let cup = Profile::from(0.0, 0.737).line(0.028, 0.737).curve((0.042, 0.76), (0.04, 0.82), 4.0).line(0.036, 0.82).curve(
        (0.036, 0.77),
        (0.0, 0.745),
        4.0,
    );
    for i in 0..4 {
        let around = Affine3A::from_rotation_y(FRAC_PI_2 * i as f32);
        for (profile, at, sides) in [(&plate, Vec3::Z * 0.33, 28.0), (&cup, Vec3::new(0.16, 0.0, 0.26), 18.0)] {
            let mut it = Mesh::default();
            it.lathe(profile, detail.count(sides, 6), detail, 0.3);
            china.append(&it, around * Affine3A::from_translation(at));
        }
    }
    let jug = Profile::from(0.0, 0.737)
        .line(0.05, 0.737)
        .curve((0.11, 0.82), (0.05, 0.92), 6.0)
        .curve((0.045, 0.96), (0.06, 1.0), 4.0)
        .line(0.052, 1.0)
        .curve((0.035, 0.95), (0.0, 0.90), 4.0);
    china.lathe(&jug, detail.count(24.0, 6), detail, 0.3);
    (wood, china)
}
