//! Scenes made by code: nothing to load, the same bytes in every run.

mod atrium;
mod caustics;
mod cornell;
mod foliage;
mod noise;
mod parts;
#[cfg(test)]
mod probe;
mod profile;
mod shapes;
mod street;
mod texels;
mod textures;

pub use atrium::{Atrium, atrium};
pub use caustics::{Caustics, caustics};
pub use cornell::cornell;
pub use street::{Street, street};

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
