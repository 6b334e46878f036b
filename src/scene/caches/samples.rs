//! Samples of a model's surface: small parts of its triangles, each as a place, a normal and an area.

use super::Spacing;
use super::models::{Model, Triangle};
use glam::Vec3;
use rayon::prelude::*;

/// A part of a triangle's side.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub position: Vec3,
    pub normal: Vec3,
    /// m^2.
    pub area: f32,
    /// Index in [`Model::triangles`].
    pub triangle: u32,
    /// Weights of the triangle's second and third corner.
    pub weights: [f32; 2],
    /// Two edges from one of the part's corners, by the same weights.
    pub edges: [[f32; 2]; 2],
}

/// Longest edge of a part, metres.
pub(super) fn edge(spacing: Spacing) -> f32 {
    spacing.distance / 8.0
}

/// Samples of all triangles, in their order. Two-sided triangles have those of both sides.
pub(super) fn of(model: &Model, spacing: Spacing) -> Vec<Sample> {
    let longest = edge(spacing);
    let of_triangle = |(number, triangle): (usize, &Triangle)| parts(number as u32, triangle, longest);
    model.triangles.par_iter().enumerate().flat_map_iter(of_triangle).collect()
}

/// Parts of a triangle with no edge over `longest`: the longest edge is halved until there is none.
fn parts(number: u32, triangle: &Triangle, longest: f32) -> Vec<Sample> {
    let [a, b, c] = triangle.positions;
    let at = |weights: [f32; 2]| a + weights[0] * (b - a) + weights[1] * (c - a);
    let area = triangle.area();
    let facing = (b - a).cross(c - a);
    let mut samples = Vec::new();
    if !(area > 0.0 && area.is_finite()) {
        return samples;
    }
    let mut open = vec![([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], area)];
    while let Some((corners, area)) = open.pop() {
        // Lengths by weights, since places far from the origin are rounded to more than a part.
        let edge = |k: usize| {
            let [from, to] = [corners[k], corners[(k + 1) % 3]];
            (to[0] - from[0]) * (b - a) + (to[1] - from[1]) * (c - a)
        };
        let lengths = [0, 1, 2].map(|k| edge(k).length_squared());
        let k = (0..3).fold(0, |most, k| if lengths[k] > lengths[most] { k } else { most });
        if lengths[k] > longest * longest {
            let [from, to, rest] = [0, 1, 2].map(|i| corners[(k + i) % 3]);
            let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
            open.extend([([middle, to, rest], 0.5 * area), ([from, middle, rest], 0.5 * area)]);
            continue;
        }
        let weights = [0, 1].map(|i| (corners[0][i] + corners[1][i] + corners[2][i]) / 3.0);
        let [n0, n1, n2] = triangle.normals;
        let normal = (1.0 - weights[0] - weights[1]) * n0.normalize_or_zero()
            + weights[0] * n1.normalize_or_zero()
            + weights[1] * n2.normalize_or_zero();
        let normal = normal.try_normalize().unwrap_or_else(|| facing.normalize_or(Vec3::Y));
        let [from, edges @ ..] = corners;
        let edges = edges.map(|to| [to[0] - from[0], to[1] - from[1]]);
        let sample = Sample { position: at(weights), normal, area, triangle: number, weights, edges };
        samples.push(sample);
        if triangle.double_sided {
            samples.push(Sample { normal: -normal, ..sample });
        }
    }
    samples
}
