//! Scenes made by code: nothing to load, the same bytes in every run.

mod atrium;
mod caustics;
mod cornell;
mod foliage;
mod materials;
mod noise;
mod parts;
#[cfg(test)]
mod probe;
mod profile;
mod shapes;
mod street;
mod texels;
mod textures;

pub use atrium::{Atrium, Courtyard, atrium, courtyard};
pub use caustics::{Caustics, caustics};
pub use cornell::cornell;
pub use street::{Street, street};

use super::Light;
use glam::{Affine3A, Quat, Vec3};

/// Level of detail of curved surfaces; 1 is the default scene's.
#[derive(Debug, Clone, Copy)]
struct Detail(f32);

impl Detail {
    /// Number of divisions of a surface that has `full` of them at detail 1, at least `least`.
    fn count(self, full: f32, least: usize) -> usize {
        ((full * self.0).round() as usize).max(least)
    }

    /// Whether a small feature is built at this level: at any level over `from`. Features begin at different levels, so that
    /// the number of triangles grows in small steps.
    fn shows(self, from: f32) -> bool {
        self.0 > from
    }
}

/// The sun of the large scenes.
fn sun(direction: Vec3) -> Light {
    Light::Directional { direction: direction.normalize(), irradiance: Vec3::new(22.0, 20.5, 18.0) }
}

/// A place turned about the vertical.
fn place(x: f32, y: f32, z: f32, turn: f32) -> Affine3A {
    Affine3A::from_rotation_translation(Quat::from_rotation_y(turn), Vec3::new(x, y, z))
}
