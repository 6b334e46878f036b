//! Shapes of the built-in scenes: patches, boxes, turned and swept mouldings, divided as finely as asked.

use super::{Detail, profile::Profile};
use crate::scene::builder::Mesh;
use glam::{Affine3A, Vec2, Vec3};
use std::f32::consts::{PI, TAU};

impl Mesh {
    /// A grid of `nu * nv` cells over the unit square; `at` gives position, unit normal and texture coordinates. Triangles face
    /// the side of their normals. Degenerate triangles are left out.
    pub(super) fn patch(&mut self, nu: usize, nv: usize, at: impl Fn(f32, f32) -> (Vec3, Vec3, Vec2)) {
        let base = self.positions.len() as u32;
        for j in 0..=nv {
            for i in 0..=nu {
                let (position, normal, uv) = at(i as f32 / nu as f32, j as f32 / nv as f32);
                self.vertex(position, normal, uv);
            }
        }
        let row = nu as u32 + 1;
        for j in 0..nv as u32 {
            for i in 0..nu as u32 {
                let a = base + j * row + i;
                self.facing([a, a + 1, a + row + 1]);
                self.facing([a, a + row + 1, a + row]);
            }
        }
    }

    /// Adds a triangle that faces the side of its normals; a degenerate one is left out.
    pub(super) fn facing(&mut self, [a, b, c]: [u32; 3]) {
        let [pa, pb, pc] = [a, b, c].map(|i| self.positions[i as usize]);
        let area = (pb - pa).cross(pc - pa);
        let longest = pa.distance_squared(pb).max(pb.distance_squared(pc)).max(pc.distance_squared(pa));
        if area.length() <= 1e-5 * longest {
            return;
        }
        let normal: Vec3 = [a, b, c].map(|i| self.normals[i as usize]).iter().sum();
        self.indices.extend(if area.dot(normal) >= 0.0 { [a, b, c] } else { [a, c, b] });
    }

    /// Gives corners whose normal is behind their triangle, or nearly so, a vertex of their own with the triangle's normal: a surface of few
    /// cells has an edge where it bends so sharply.
    pub(super) fn crease(&mut self) {
        for first in (0..self.indices.len()).step_by(3) {
            let corners: [usize; 3] = std::array::from_fn(|i| self.indices[first + i] as usize);
            let [a, b, c] = corners.map(|i| self.positions[i]);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            for (i, corner) in corners.into_iter().enumerate() {
                if self.normals[corner].dot(normal) < 0.05 {
                    self.indices[first + i] = self.vertex(self.positions[corner], normal, self.uvs[corner]);
                }
            }
        }
    }

    /// A patch whose normals are computed from the surface: along `du x dv`, or against it if `flip` is set. The differences
    /// span the cells around a vertex, so that a coarse mesh is shaded by its own shape. `position` is also evaluated a little
    /// outside [0, 1] in `u`.
    pub(super) fn surface(&mut self, [nu, nv]: [usize; 2], flip: bool, position: impl Fn(f32, f32) -> Vec3, uv: impl Fn(f32, f32) -> Vec2) {
        let (hu, hv) = (0.9 / nu as f32, 0.9 / nv as f32);
        self.patch(nu, nv, |u, v| {
            // Normals of a pole are taken next to it: a surface that ends in a point has no normal there.
            let inside = v.clamp(0.3 * hv, 1.0 - 0.3 * hv);
            let du = position(u + hu, inside) - position(u - hu, inside);
            let dv = position(u, (v + hv).min(1.0)) - position(u, (v - hv).max(0.0));
            let normal = du.cross(dv).normalize_or(Vec3::Y);
            (position(u, v), if flip { -normal } else { normal }, uv(u, v))
        });
    }

    /// A flat parallelogram from `origin` along `u` and `v`, facing `u x v`, in cells of at most `cell` metres. Texture
    /// coordinates are metres over `tile`; `start` is the corner's place on a larger plane.
    pub(super) fn plane(&mut self, origin: Vec3, u: Vec3, v: Vec3, cell: f32, tile: f32, start: Vec2) {
        let (lu, lv) = (u.length(), v.length());
        let cells = |length: f32| ((length / cell).round() as usize).max(1);
        let normal = u.cross(v).normalize();
        self.patch(cells(lu), cells(lv), |a, b| {
            (origin + u * a + v * b, normal, Vec2::new((start.x + a * lu) / tile, -(start.y + b * lv) / tile))
        });
    }

    /// The faces of a box in `faces` (any of `-x+x-y+y-z+z`, a sign and a letter each), textured in metres over `tile`.
    pub(super) fn cuboid(&mut self, min: Vec3, max: Vec3, faces: &str, tile: f32) {
        self.divided_cuboid(min, max, faces, f32::INFINITY, tile);
    }

    /// The faces of a box in cells of at most `cell` metres.
    pub(super) fn divided_cuboid(&mut self, min: Vec3, max: Vec3, faces: &str, cell: f32, tile: f32) {
        let size = max - min;
        let cells = |length: f32| ((length / cell - 1e-3).ceil() as usize).max(1);
        for face in faces.as_bytes().chunks(2) {
            let axis = match face[1] {
                b'x' => 0,
                b'y' => 1,
                _ => 2,
            };
            let positive = face[0] == b'+';
            let mut normal = Vec3::ZERO;
            normal[axis] = if positive { 1.0 } else { -1.0 };
            // Texture v goes up on walls, and along z on floors.
            let (right, up) = match axis {
                0 => (Vec3::Z, Vec3::Y),
                1 => (Vec3::X, Vec3::Z),
                _ => (Vec3::X, Vec3::Y),
            };
            let mut corner = min;
            corner[axis] = if positive { max[axis] } else { min[axis] };
            let (u, v) = (right * size, up * size);
            self.patch(cells(u.length()), cells(v.length()), |a, b| {
                let p = corner + u * a + v * b;
                (p, normal, Vec2::new(p.dot(right), -p.dot(up)) / tile)
            });
        }
    }

    /// Turns a profile (radius, height) around the y axis. Texture coordinates along the profile are metres over `tile`; around
    /// it the texture repeats the nearest whole number of times.
    pub(super) fn lathe(&mut self, profile: &Profile, sides: usize, detail: Detail, tile: f32) {
        let runs = profile.runs(detail);
        let widest = runs.iter().flatten().map(|s| s.point.x).fold(0.0, f32::max);
        let repeats = (TAU * widest / tile).round().max(1.0);
        for run in runs {
            let last = run.len() - 1;
            self.patch(sides, last, |u, v| {
                let sample = run[(v * last as f32).round() as usize];
                let (sin, cos) = if u == 1.0 { (0.0, 1.0) } else { (TAU * u).sin_cos() };
                let position = Vec3::new(sample.point.x * cos, sample.point.y, -sample.point.x * sin);
                let normal = Vec3::new(sample.normal.x * cos, sample.normal.y, -sample.normal.x * sin);
                (position, normal, Vec2::new(u * repeats, -sample.length / tile))
            });
        }
    }

    /// Runs a profile (distance inwards from the rectangle `half`, height) along the inside of the rectangle on the floor
    /// plane, mitred at its corners. With `outward` it runs along the outside, and distances count outwards.
    pub(super) fn frame(&mut self, profile: &Profile, half: Vec2, outward: bool, cell: f32, detail: Detail, tile: f32) {
        let sign = if outward { 1.0 } else { -1.0 };
        for side in 0..4 {
            let (along, across) = if side % 2 == 0 { (half.x, half.y) } else { (half.y, half.x) };
            let (right, out) = match side {
                0 => (Vec3::X, Vec3::Z),
                1 => (Vec3::NEG_Z, Vec3::X),
                2 => (Vec3::NEG_X, Vec3::NEG_Z),
                _ => (Vec3::Z, Vec3::NEG_X),
            };
            for run in profile.runs(detail) {
                let last = run.len() - 1;
                let cells = ((2.0 * along / cell).round() as usize).max(1);
                self.patch(cells, last, |u, v| {
                    let sample = run[(v * last as f32).round() as usize];
                    let offset = sign * sample.point.x;
                    let x = (2.0 * u - 1.0) * (along + offset);
                    let position = right * x + out * (across + offset) + Vec3::Y * sample.point.y;
                    let normal = out * (sign * sample.normal.x) + Vec3::Y * sample.normal.y;
                    (position, normal, Vec2::new(x, -sample.length) / tile)
                });
            }
        }
    }

    /// Runs a profile (radius, height over the wall) around the half circle above the springing line at `center`, in the xy
    /// plane, facing +z. The profile goes from the inner edge over the top to the outer one.
    pub(super) fn archivolt(&mut self, profile: &Profile, center: Vec3, segments: usize, detail: Detail, tile: f32) {
        for run in profile.runs(detail) {
            let last = run.len() - 1;
            self.patch(segments, last, |u, v| {
                let sample = run[(v * last as f32).round() as usize];
                let (sin, cos) = (PI * u).sin_cos();
                let position = center + Vec3::new(sample.point.x * cos, sample.point.x * sin, sample.point.y);
                // The profile goes outwards with the solid below it: its left-hand side is outside here.
                let normal = -Vec3::new(sample.normal.x * cos, sample.normal.x * sin, sample.normal.y);
                (position, normal, Vec2::new(PI * u * sample.point.x.max(0.2), -sample.length) / tile)
            });
        }
    }

    /// Adds another mesh's triangles, transformed.
    pub(super) fn append(&mut self, other: &Mesh, transform: Affine3A) {
        let base = self.positions.len() as u32;
        let normals = transform.matrix3.inverse().transpose();
        let mirrored = transform.matrix3.determinant() < 0.0;
        self.positions.extend(other.positions.iter().map(|&p| transform.transform_point3(p)));
        self.normals.extend(other.normals.iter().map(|&n| (normals * n).normalize()));
        self.uvs.extend_from_slice(&other.uvs);
        self.indices.extend(other.indices.chunks_exact(3).flat_map(|t| {
            let [a, b, c] = [t[0] + base, t[1] + base, t[2] + base];
            if mirrored { [a, c, b] } else { [a, b, c] }
        }));
    }
}
