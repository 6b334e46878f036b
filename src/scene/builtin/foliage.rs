//! Crowns of trees: sprigs of leaves all over a ball.

use super::noise::Random;
use crate::scene::builder::Mesh;
use glam::{Vec2, Vec3};

/// A crown of sprigs, each a cut-out sheet.
pub struct Crown {
    pub center: Vec3,
    pub radius: f32,
    /// Stretch of the ball.
    pub aspect: Vec3,
    /// Number of sprigs, and the length of one.
    pub sprigs: usize,
    pub size: f32,
}

impl Crown {
    /// The crown. `cells` divides a sprig: along it, and across.
    pub fn grow(&self, random: &mut Random, cells: impl Fn(usize) -> [usize; 2]) -> Mesh {
        let mut crown = Mesh::default();
        let size = self.size;
        for i in 0..self.sprigs {
            let out = direction(i, self.sprigs, random);
            let radius = self.radius * random.range(0.62, 1.0) * (1.0 + 0.10 * (3.0 * out.x + 5.0 * out.z).sin());
            let foot = self.center + out * self.aspect * (radius - 0.35 * size);
            let lean = (out + Vec3::new(random.range(-0.7, 0.7), random.range(-0.3, 0.7), random.range(-0.7, 0.7))).normalize();
            let right = lean.cross(Vec3::new(random.range(-1.0, 1.0), 1.0, random.range(-1.0, 1.0))).normalize_or(Vec3::X);
            let up = right.cross(lean).normalize();
            let outward = if up.dot(out) < 0.0 { -up } else { up };
            let (length, half, droop) = (size * random.range(0.8, 1.2), size * 0.45, random.range(0.02, 0.35) * size);
            crown.surface(
                cells(i),
                false,
                |u, v| {
                    let side = 2.0 * u - 1.0;
                    foot + lean * (length * v) + right * (half * side) - outward * (droop * v * v + 0.18 * half * side * side)
                },
                |u, v| Vec2::new(u, 1.0 - v),
            );
        }
        crown
    }
}

/// The i-th of n directions, evenly spread and jittered a little.
pub fn direction(i: usize, n: usize, random: &mut Random) -> Vec3 {
    let z = 1.0 - 2.0 * (i as f32 + 0.5) / n as f32;
    let (sin, cos) = (i as f32 * 2.399_963 + random.range(-0.2, 0.2)).sin_cos();
    let r = (1.0 - z * z).sqrt();
    Vec3::new(r * cos, z, r * sin)
}
