//! Cars, parked in bays along both kerbs, and a few on their way.

use super::meshes::{Meshes, mix};
use super::{BAY, Plan, place};
use crate::scene::builder::Mesh;
use crate::scene::builtin::Detail;
use crate::scene::builtin::noise::{Random, smooth};
use crate::scene::builtin::parts::Part;
use crate::scene::builtin::profile::Profile;
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};

/// Measures of a car, m: x ahead, y up, z to its right, the origin on the road under its middle.
struct Shape {
    /// Half the body's length and width.
    half: Vec2,
    /// Places of the axles.
    axles: [f32; 2],
    /// Radius of the wheels.
    wheel: f32,
    /// Height of the bonnet's front end, of the body under the windows, and of its rear end.
    deck: [f32; 3],
    /// Where the cabin ends behind and begins in front, at the body and at the roof.
    cabin: [f32; 2],
    roof: [f32; 2],
    /// Height of the roof.
    height: f32,
    /// Width of the roof, as a part of that of the body.
    narrow: f32,
}

const SHAPES: [Shape; 3] = [
    // A hatchback, a saloon and a van.
    Shape {
        half: Vec2::new(1.98, 0.87),
        axles: [-1.22, 1.27],
        wheel: 0.31,
        deck: [0.74, 0.95, 0.98],
        cabin: [-1.90, 1.02],
        roof: [-1.42, 0.22],
        height: 1.47,
        narrow: 0.74,
    },
    Shape {
        half: Vec2::new(2.25, 0.89),
        axles: [-1.35, 1.40],
        wheel: 0.32,
        deck: [0.70, 0.92, 0.96],
        cabin: [-1.62, 0.98],
        roof: [-0.95, 0.18],
        height: 1.42,
        narrow: 0.72,
    },
    Shape {
        half: Vec2::new(2.42, 0.96),
        axles: [-1.50, 1.52],
        wheel: 0.34,
        deck: [0.95, 1.12, 1.16],
        cabin: [-2.39, 1.72],
        roof: [-2.28, 0.98],
        height: 1.98,
        narrow: 0.86,
    },
];

/// Bays on the sunny side and in the shade with a car: the bay, the car's shape, its paint.
const SUNNY: [(i32, usize, usize); 9] =
    [(-8, 0, 3), (-7, 1, 2), (-5, 0, 4), (-3, 2, 1), (-2, 0, 0), (0, 1, 3), (2, 0, 6), (3, 1, 5), (7, 0, 1)];
const SHADY: [(i32, usize, usize); 11] =
    [(-8, 1, 5), (-6, 0, 1), (-5, 1, 0), (-3, 0, 2), (-2, 1, 3), (0, 0, 4), (1, 2, 3), (3, 1, 1), (4, 0, 0), (6, 1, 6), (8, 0, 3)];
/// Cars on their way: place, turn, shape, paint.
const DRIVING: [([f32; 2], f32, usize, usize); 3] =
    [([-14.0, 1.45], 0.0, 1, 1), ([22.0, -1.5], PI, 0, 0), ([61.2, -11.0], FRAC_PI_2, 2, 2)];

pub fn parts(plan: &Plan) -> Vec<Part> {
    let palette = &plan.palette;
    let mut random = Random::new(plan.seed ^ 0xca25);
    let mut cars: [Vec<(Affine3A, u32)>; SHAPES.len()] = std::array::from_fn(|_| Vec::new());
    for (bays, z, turn) in [(&SUNNY[..], -3.82, PI), (&SHADY[..], 3.82, 0.0)] {
        for (bay, shape, paint) in bays {
            let (x, aside, skew) = (random.range(-0.35, 0.35), random.range(-0.08, 0.08), random.range(-0.025, 0.025));
            let at = place(BAY * *bay as f32 + x, 0.0, z + aside, turn + skew);
            cars[*shape].push((at, palette.paints[*paint]));
        }
    }
    for ([x, z], turn, shape, paint) in DRIVING {
        cars[shape].push((place(x, 0.0, z, turn), palette.paints[paint]));
    }
    let mut parts = Vec::new();
    for (number, (shape, places)) in SHAPES.iter().zip(&cars).enumerate() {
        let (paint, rest) = shape.build(&plan.of(number as u32 + 70));
        parts.push(Part::painted(paint, places));
        let transforms: Vec<_> = places.iter().map(|(transform, _)| *transform).collect();
        parts.extend(rest.into_instances(&transforms));
    }
    parts
}

/// A power that keeps the sign.
fn power(x: f32, exponent: f32) -> f32 {
    x.abs().powf(exponent).copysign(x)
}

/// Exponent of the body's sections: they are between an ellipse and a rectangle.
const BOXY: f32 = 3.6;
/// Height of the body's widest line, and of the sills.
const WAIST: f32 = 0.52;
const SILL: f32 = 0.20;

/// How cars are simplified where there are few triangles.
#[derive(Clone, Copy)]
struct Cut {
    /// Whether the body is cut out over the wheels. Otherwise these stand out of it a little.
    arches: bool,
    /// How far the body's ends stay open: to 0, where they round off, or to this part of a section, which a flat face closes. A round end
    /// of one section or two would be a wedge.
    blunt: f32,
    /// How far the cabin's foot stands below the edge of a body's smooth sections, and how wide it is. The flat sides of a body of few
    /// sections lie deeper and farther in.
    foot: [f32; 2],
}

impl Cut {
    fn of(detail: Detail) -> Self {
        let arches = detail.shows(0.22);
        let blunt = match ends(detail) {
            _ if !arches => 0.72,
            ..=2 => 0.45,
            _ => 0.0,
        };
        Self { arches, blunt, foot: if rows(detail) < 8 { [0.22, 0.89] } else { [0.06, 0.945] } }
    }
}

/// Number of sections at each end of the body, from the wheels on, and of cells around a section.
fn ends(detail: Detail) -> usize {
    detail.count(7.0, 1)
}

fn rows(detail: Detail) -> usize {
    detail.count(18.0, 5)
}

impl Shape {
    /// What has the car's paint, and all else.
    fn build(&self, plan: &Plan) -> (Mesh, Meshes) {
        let palette = &plan.palette;
        let (mut paint, mut rest) = (Mesh::default(), Meshes::default());
        self.body(&mut paint, plan);
        self.cabin(&mut paint, rest.of(palette.car_glass), plan);
        let rubber = rest.of(palette.rubber);
        self.underside(rubber, plan);
        let inset = if Cut::of(plan.detail).arches { 0.13 } else { 0.085 };
        for axle in self.axles {
            for hand in [-1.0, 1.0] {
                let side = Affine3A::from_translation(Vec3::new(axle, self.wheel, hand * (self.half.y - inset)))
                    * Affine3A::from_rotation_x(hand * FRAC_PI_2);
                let (tyre, hub) = self.wheel(plan);
                rest.of(palette.rubber).append(&tyre, side);
                rest.of(palette.hubs).append(&hub, side);
            }
        }
        self.lamps(&mut rest, plan);
        (paint, rest)
    }

    /// Height of the body's upper side, before its ends round off.
    fn deck(&self, x: f32) -> f32 {
        let [front, middle, rear] = self.deck;
        if x > self.cabin[1] {
            let t = ((x - self.cabin[1]) / (self.half.x - self.cabin[1])).clamp(0.0, 1.0);
            mix(middle, front, t * t * 0.6 + 0.4 * t)
        } else {
            let t = ((self.cabin[0] + 0.9 - x) / (self.half.x + self.cabin[0] + 0.9).max(0.3)).clamp(0.0, 1.0);
            mix(middle, rear, smooth(t))
        }
    }

    /// How far the body has closed towards its ends: 1 in the middle, 0 at the ends.
    fn end(&self, x: f32, cut: Cut) -> f32 {
        let round = if x > 0.0 { 0.55 } else { 0.38 };
        let t = ((x.abs() - (self.half.x - round)) / round).clamp(0.0, 1.0);
        (1.0 - t.powf(2.6)).max(0.0).powf(1.0 / 2.6).max(cut.blunt)
    }

    /// A point of the body: on the section at `x`, at an angle from its right side over the top.
    fn skin(&self, x: f32, angle: f32, cut: Cut) -> Vec3 {
        let (sin, cos) = angle.sin_cos();
        let end = self.end(x, cut);
        let up = if sin > 0.0 { self.deck(x) - WAIST } else { WAIST - SILL + 0.08 };
        let plan = 1.0 - 0.10 * (x / self.half.x).powi(4);
        let width = self.half.y * plan * (0.80 + 0.20 * end);
        Vec3::new(x, WAIST + up * end * power(sin, 2.0 / BOXY), width * power(cos, 2.0 / BOXY))
    }

    /// Angle at which the section at `x` begins: at the sill, or at the arch over a wheel.
    fn begin(&self, x: f32, cut: Cut) -> f32 {
        let arch = self.axles.iter().map(|axle| {
            let (dx, radius) = (x - axle, self.wheel + 0.065);
            if dx.abs() < radius - 1e-3 { self.wheel + (radius * radius - dx * dx).max(0.0).sqrt() } else { 0.0 }
        });
        let foot = if cut.arches { arch.fold(SILL, f32::max) } else { SILL };
        let end = self.end(x, cut).max(1e-3);
        let s = foot - WAIST;
        let up = if s > 0.0 { self.deck(x) - WAIST } else { WAIST - SILL + 0.08 };
        power((s / (up * end)).clamp(-0.99, 0.99), 0.5 * BOXY).asin()
    }

    /// Places of the sections: close together at the ends and along the arches.
    fn stations(&self, plan: &Plan) -> Vec<f32> {
        let (ends, arch, middle) = (ends(plan.detail), plan.detail.count(12.0, 3), plan.detail.count(6.0, 1));
        if !Cut::of(plan.detail).arches {
            return vec![-self.half.x, self.axles[0], self.axles[1], self.half.x];
        }
        let radius = self.wheel + 0.065;
        let [rear, front] = self.axles;
        let mut xs = Vec::new();
        for i in 0..ends {
            // Denser towards the very end.
            let t = 1.0 - i as f32 / ends as f32;
            xs.push(mix(rear - radius, -self.half.x, (FRAC_PI_2 * t).sin()));
        }
        let arc = |axle: f32| (0..=arch).map(move |i| axle - radius * (PI * i as f32 / arch as f32).cos());
        xs.extend(arc(rear));
        xs.extend((1..middle).map(|i| mix(rear + radius, front - radius, i as f32 / middle as f32)));
        xs.extend(arc(front));
        for i in 1..=ends {
            let t = i as f32 / ends as f32;
            xs.push(mix(front + radius, self.half.x, (FRAC_PI_2 * t).sin()));
        }
        xs
    }

    /// The body, open below. Its normals span the cells around a vertex, so that a body of few sections is shaded by its own
    /// shape, as if no arches were cut out.
    fn body(&self, mesh: &mut Mesh, plan: &Plan) {
        let (xs, rows, cut) = (self.stations(plan), rows(plan.detail), Cut::of(plan.detail));
        let last = xs.len() - 1;
        let begins: Vec<f32> = xs.iter().map(|x| self.begin(*x, cut)).collect();
        let angle = |i: usize, v: f32| mix(begins[i], PI - begins[i], v);
        mesh.patch(last, rows, |u, v| {
            let i = (u * last as f32).round() as usize;
            let (before, after) = (xs[i.saturating_sub(1)], xs[(i + 1).min(last)]);
            let (angle, step) = (angle(i, v), (PI - 2.0 * begins[i]) / rows as f32);
            let du = self.skin(after, angle, cut) - self.skin(before, angle, cut);
            let dv = self.skin(xs[i], angle + step, cut) - self.skin(xs[i], angle - step, cut);
            (self.skin(xs[i], angle, cut), du.cross(dv).normalize_or(Vec3::Y), Vec2::new(xs[i], angle))
        });
        if cut.blunt > 0.0 {
            for (i, normal) in [(0, Vec3::NEG_X), (last, Vec3::X)] {
                let rim: Vec<Vec3> = (0..=rows).map(|j| self.skin(xs[i], angle(i, j as f32 / rows as f32), cut)).collect();
                mesh.cap(&rim, normal, 1.0);
            }
        }
        mesh.crease();
    }

    /// A point of the cabin: `u` from its rear end to its front, `v` from the right side over the roof to the left one.
    fn hull(&self, u: f32, v: f32, cut: Cut) -> Vec3 {
        let (t, v) = (smooth(u.clamp(0.0, 1.0)), v.clamp(0.0, 1.0));
        let (sin, cos) = (PI * v).sin_cos();
        let round = (1.0 - (2.0 * t - 1.0).powi(4)).max(0.0).powf(0.25);
        // The ends lean from the body to the roof.
        let up = round * power(sin, 2.0 / BOXY);
        let x = mix(mix(self.cabin[0], self.roof[0], up), mix(self.cabin[1], self.roof[1], up), t);
        let [foot, wide] = cut.foot;
        let base = self.deck(x).min(self.deck[1]) - foot;
        let width = self.half.y * mix(wide, self.narrow, up) * (0.88 + 0.12 * round);
        Vec3::new(x, mix(base, self.height, up), width * power(cos, 2.0 / BOXY))
    }

    /// The cabin: windows between pillars, and a roof.
    fn cabin(&self, paint: &mut Mesh, glass: &mut Mesh, plan: &Plan) {
        // Lines along the cabin and around it, and which fields between them are glass.
        let (along, around): (&[f32], &[f32]) = if plan.detail.shows(0.14) {
            (&[0.0, 0.03, 0.17, 0.215, 0.48, 0.515, 0.77, 0.83, 0.97, 1.0], &[0.0, 0.20, 0.30, 0.70, 0.80, 1.0])
        } else {
            (&[0.0, 0.17, 0.83, 1.0], &[0.0, 0.25, 0.75, 1.0])
        };
        let (fine, cut) = (along.len() > 4, Cut::of(plan.detail));
        for (i, u) in along.windows(2).enumerate() {
            for (j, v) in around.windows(2).enumerate() {
                let side = matches!(i, 3 | 5) && matches!(j, 0 | 4);
                let ends = matches!(i, 0 | 1 | 7 | 8) && j == 2;
                let mesh = if fine && (side || ends) || !fine && (i != 1 || j != 1) { &mut *glass } else { &mut *paint };
                let cells = [plan.detail.count(30.0 * (u[1] - u[0]), 1), plan.detail.count(26.0 * (v[1] - v[0]), 1)];
                mesh.surface(
                    cells,
                    false,
                    |a, b| self.hull(u[0] + (u[1] - u[0]) * a, v[0] + (v[1] - v[0]) * b, cut),
                    |a, b| Vec2::new(u[0] + (u[1] - u[0]) * a, v[0] + (v[1] - v[0]) * b),
                );
            }
        }
    }

    /// A dark floor between the wheels, and linings in the arches.
    fn underside(&self, mesh: &mut Mesh, plan: &Plan) {
        let (length, width) = (self.half.x - 0.22, self.half.y - 0.26);
        if !Cut::of(plan.detail).arches {
            // The body's lower edge hides all but the floor.
            let length = length - 0.3;
            mesh.cuboid(Vec3::new(-length, SILL - 0.03, -width), Vec3::new(length, SILL + 0.1, width), "-x+x-y-z+z", 1.0);
            return;
        }
        mesh.solid(Vec3::new(-length, SILL - 0.03, -width), Vec3::new(length, WAIST + 0.08, width), f32::INFINITY, 1.0);
        let radius = self.wheel + 0.06;
        for axle in self.axles {
            mesh.patch(plan.detail.count(10.0, 4), 2, |u, v| {
                let (sin, cos) = (PI * (1.1 * u - 0.05)).sin_cos();
                let z = mix(-self.half.y + 0.035, self.half.y - 0.035, v);
                (Vec3::new(axle - radius * cos, self.wheel + radius * sin, z), Vec3::new(cos, -sin, 0.0), Vec2::new(u, v))
            });
        }
        // Sills and bumpers close the body below.
        let [rear, front] = self.axles;
        let gap = self.wheel + 0.07;
        for [from, to] in [[-length, rear - gap], [rear + gap, front - gap], [front + gap, length]] {
            let side = self.half.y - 0.07;
            mesh.solid(Vec3::new(from, SILL - 0.035, -side), Vec3::new(to, SILL + 0.09, side), f32::INFINITY, 1.0);
        }
    }

    /// A tyre and its hub about the y axis, which points outwards.
    fn wheel(&self, plan: &Plan) -> (Mesh, Mesh) {
        let (radius, half) = (self.wheel, 0.105);
        let sides = plan.detail.count(26.0, 6);
        let (mut tyre, mut hub) = (Mesh::default(), Mesh::default());
        let profile = Profile::from(0.60 * radius, -half)
            .line(0.86 * radius, -half)
            .curve((radius, -half), (radius, -0.5 * half), 3.0)
            .line(radius, 0.5 * half)
            .curve((radius, half), (0.86 * radius, half), 3.0)
            .line(0.62 * radius, 0.95 * half);
        if !plan.detail.shows(0.12) {
            tyre.lathe(&Profile::from(radius, -half).line(radius, half).line(0.0, half), sides, plan.detail, 0.5);
            return (tyre, hub);
        }
        tyre.lathe(&profile, sides, plan.detail, 0.5);
        let profile = Profile::from(0.66 * radius, 0.90 * half)
            .line(0.60 * radius, 0.96 * half)
            .line(0.56 * radius, 0.62 * half)
            .curve((0.30 * radius, 0.95 * half), (0.12 * radius, 0.85 * half), 3.0)
            .line(0.10 * radius, 1.0 * half)
            .line(0.0, 1.0 * half);
        hub.lathe(&profile, sides, plan.detail, 0.5);
        (tyre, hub)
    }

    /// Lamps, the grille and the number plates.
    fn lamps(&self, rest: &mut Meshes, plan: &Plan) {
        let palette = &plan.palette;
        let mut ball = Mesh::default();
        let profile = Profile::from(0.0, -1.0).curve((1.0, -1.0), (1.0, 0.0), 4.0).curve((1.0, 1.0), (0.0, 1.0), 4.0);
        ball.lathe(&profile, plan.detail.count(14.0, 5), plan.detail, 1.0);
        let mut bead = |material: u32, at: Vec3, size: Vec3| {
            rest.of(material).append(&ball, Affine3A::from_translation(at) * Affine3A::from_scale(size));
        };
        let (x, side, cut) = (self.half.x, self.half.y, Cut::of(plan.detail));
        if !plan.detail.shows(0.13) {
            return;
        }
        for hand in [-1.0, 1.0] {
            let front = self.skin(x - 0.13, 0.75, cut);
            bead(
                palette.headlamps,
                Vec3::new(x - 0.17, 0.5 * (front.y + WAIST) + 0.05, hand * (side - 0.27)),
                Vec3::new(0.13, 0.085, 0.17),
            );
            let height = 0.5 * (self.deck[2] + WAIST) + 0.06;
            bead(palette.tail_lamps, Vec3::new(0.115 - x, height, hand * (side - 0.20)), Vec3::new(0.065, 0.11, 0.09));
            // Mirrors.
            let mirror = self.hull(0.86, 0.08, cut);
            bead(palette.rubber, Vec3::new(mirror.x + 0.05, mirror.y + 0.02, hand * (mirror.z.abs() + 0.10)), Vec3::new(0.07, 0.07, 0.10));
        }
        let rubber = rest.of(palette.rubber);
        rubber.solid(Vec3::new(x - 0.3, 0.36, -0.42), Vec3::new(x - 0.008, 0.46, 0.42), f32::INFINITY, 1.0);
        for (from, to, height) in [(x - 0.2, x + 0.012, 0.50), (-x - 0.012, 0.2 - x, 0.62)] {
            rest.of(palette.headlamps).solid(Vec3::new(from, height, -0.26), Vec3::new(to, height + 0.11, 0.26), f32::INFINITY, 1.0);
        }
    }
}
