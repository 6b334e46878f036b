//! Meshes of several materials, and the flat and moulded surfaces that houses and ground are made of.

use super::super::parts::Part;
use super::super::profile::{Profile, Sample};
use super::Plan;
use crate::scene::builder::Mesh;
use glam::{Affine3A, Vec2, Vec3};
use std::collections::BTreeMap;

/// Meshes by their material.
#[derive(Default)]
pub struct Meshes(BTreeMap<u32, Mesh>);

impl Meshes {
    /// The mesh of a material.
    pub fn of(&mut self, material: u32) -> &mut Mesh {
        self.0.entry(material).or_default()
    }

    /// Adds others' triangles, transformed.
    pub fn append(&mut self, other: &Self, place: Affine3A) {
        for (material, mesh) in &other.0 {
            self.of(*material).append(mesh, place);
        }
    }

    /// A part for each material.
    pub fn into_parts(self) -> Vec<Part> {
        self.0.into_iter().map(|(material, mesh)| Part::once(mesh, material)).collect()
    }

    /// A part for each material, with these instances.
    pub fn into_instances(self, places: &[Affine3A]) -> Vec<Part> {
        self.0.into_iter().map(|(material, mesh)| Part::at(mesh, material, places.to_vec())).collect()
    }
}

/// Between two numbers, and exactly these at the ends, so that neighbouring surfaces share their corners.
pub fn mix(from: f32, to: f32, t: f32) -> f32 {
    from * (1.0 - t) + to * t
}

/// Number of cells on a length.
pub fn cells(length: f32, cell: f32) -> usize {
    ((length.abs() / cell - 1e-3).ceil() as usize).max(1)
}

impl Mesh {
    /// The rectangles between successive lines `xs` and `ys` of an upright plane that faces +z, but for those that are holes.
    pub(super) fn wall(&mut self, [xs, ys]: [&[f32]; 2], z: f32, cell: f32, tile: f32, hole: impl Fn(usize, usize) -> bool) {
        for (i, x) in xs.windows(2).enumerate() {
            for (j, y) in ys.windows(2).enumerate() {
                if hole(i, j) {
                    continue;
                }
                self.patch(cells(x[1] - x[0], cell), cells(y[1] - y[0], cell), |u, v| {
                    let at = Vec3::new(mix(x[0], x[1], u), mix(y[0], y[1], v), z);
                    (at, Vec3::Z, Vec2::new(at.x, -at.y) / tile)
                });
            }
        }
    }

    /// The sides of a wall's holes, `depth` into it.
    pub(super) fn reveals(&mut self, [xs, ys]: [&[f32]; 2], z: f32, depth: f32, cell: f32, tile: f32, hole: impl Fn(usize, usize) -> bool) {
        let open = |i: usize, j: usize| i + 1 < xs.len() && j + 1 < ys.len() && hole(i, j);
        for i in 0..xs.len() - 1 {
            for j in 0..ys.len() - 1 {
                if !open(i, j) {
                    continue;
                }
                let beside = [i > 0 && open(i - 1, j), open(i + 1, j), j > 0 && open(i, j - 1), open(i, j + 1)];
                let (across, up) = (cells(xs[i + 1] - xs[i], cell), cells(ys[j + 1] - ys[j], cell));
                for (k, normal) in [Vec3::X, Vec3::NEG_X].into_iter().enumerate().filter(|(k, _)| !beside[*k]) {
                    self.patch(1, up, |u, v| {
                        let at = Vec3::new(xs[i + k], mix(ys[j], ys[j + 1], v), mix(z, z - depth, u));
                        (at, normal, Vec2::new(at.z, -at.y) / tile)
                    });
                }
                for (k, normal) in [Vec3::Y, Vec3::NEG_Y].into_iter().enumerate().filter(|(k, _)| !beside[2 + *k]) {
                    self.patch(across, 1, |u, v| {
                        let at = Vec3::new(mix(xs[i], xs[i + 1], u), ys[j + k], mix(z, z - depth, v));
                        (at, normal, Vec2::new(at.x, at.z) / tile)
                    });
                }
            }
        }
    }

    /// The rectangles between successive lines `xs` and `zs` of a floor, but for those that are holes. `uv` is of (x, z).
    pub(super) fn floor(
        &mut self,
        [xs, zs]: [&[f32]; 2],
        y: f32,
        cell: f32,
        hole: impl Fn(usize, usize) -> bool,
        uv: impl Fn(Vec2) -> Vec2,
    ) {
        for (i, x) in xs.windows(2).enumerate() {
            for (j, z) in zs.windows(2).enumerate() {
                if hole(i, j) {
                    continue;
                }
                self.patch(cells(x[1] - x[0], cell), cells(z[1] - z[0], cell), |u, v| {
                    let at = Vec3::new(mix(x[0], x[1], u), y, mix(z[0], z[1], v));
                    (at, Vec3::Y, uv(Vec2::new(at.x, at.z)))
                });
            }
        }
    }

    /// A rectangle of a picture that faces +z: `picture` is its part of the texture, left, top, right, bottom.
    pub(super) fn picture(&mut self, [x0, x1]: [f32; 2], [y0, y1]: [f32; 2], z: f32, [left, top, right, bottom]: [f32; 4], cell: f32) {
        self.patch(cells(x1 - x0, cell), cells(y1 - y0, cell), |u, v| {
            (Vec3::new(mix(x0, x1, u), mix(y0, y1, v), z), Vec3::Z, Vec2::new(mix(left, right, u), mix(bottom, top, v)))
        });
    }

    /// A small box of all faces but the one against a wall at -z, textured in metres over `tile`.
    pub(super) fn block(&mut self, [x0, x1]: [f32; 2], [y0, y1]: [f32; 2], [z0, z1]: [f32; 2], tile: f32) {
        self.cuboid(Vec3::new(x0, y0, z0), Vec3::new(x1, y1, z1), "-x+x-y+y+z", tile);
    }

    /// A box of all six faces, in cells.
    pub(super) fn solid(&mut self, min: Vec3, max: Vec3, cell: f32, tile: f32) {
        self.divided_cuboid(min, max, "-x+x-y+y-z+z", cell, tile);
    }

    /// A profile (distance from the wall, height) along a wall that faces +z at `z`.
    pub(super) fn moulding(&mut self, profile: &Profile, along: [f32; 2], ends: [Close; 2], z: f32, plan: &Plan, tile: f32) {
        let runs = profile.runs(plan.detail);
        let shift = ends.map(|end| if matches!(end, Close::Mitre) { 1.0 } else { 0.0 });
        let position = |u: f32, sample: &Sample| {
            let out = sample.point.x;
            Vec3::new(mix(along[0] - shift[0] * out, along[1] + shift[1] * out, u), sample.point.y, z + out)
        };
        for run in &runs {
            let last = run.len() - 1;
            self.patch(cells(along[1] - along[0], plan.cell()), last, |u, v| {
                let sample = &run[(v * last as f32).round() as usize];
                let at = position(u, sample);
                (at, Vec3::new(0.0, sample.normal.y, sample.normal.x), Vec2::new(at.x, -sample.length) / tile)
            });
        }
        for (u, normal, end) in [(0.0, Vec3::NEG_X, ends[0]), (1.0, Vec3::X, ends[1])] {
            if matches!(end, Close::Cap) {
                let points: Vec<Vec3> = runs.iter().flatten().map(|sample| position(u, sample)).collect();
                self.cap(&points, normal, tile);
            }
        }
    }

    /// A flat end: a fan over points in order, from the middle of the line between the first and the last.
    pub(super) fn cap(&mut self, points: &[Vec3], normal: Vec3, tile: f32) {
        let middle = 0.5 * (points[0] + points[points.len() - 1]);
        let uv = |p: Vec3| Vec2::new(p.z, -p.y) / tile;
        let hub = self.vertex(middle, normal, uv(middle));
        let rim: Vec<u32> = points.iter().map(|p| self.vertex(*p, normal, uv(*p))).collect();
        for pair in rim.windows(2) {
            self.facing([hub, pair[0], pair[1]]);
        }
    }
}

/// How a moulding ends.
#[derive(Debug, Clone, Copy)]
pub enum Close {
    /// Cut off flat.
    Cap,
    /// Around an outer corner, where another one meets it.
    Mitre,
}
