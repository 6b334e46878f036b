//! A street of houses and shops between two cross streets, with parked cars, trees and lamps, and coloured panels that stand in the sun.
//!
//! The street runs along x, its carriageway in the plane y = 0. The sun shines over the houses at +z: those at -z and the panels before
//! them are in its light, and what these reflect lights the pale houses at +z. At both ends a house closes the view, and so do houses at
//! the ends of the cross streets.
//!
//! Every part is a function from a level of detail to meshes. [`street`] searches the level whose drawn triangles add up to the number
//! asked for. Measures shared by several parts are constants here.

mod cars;
mod facade;
mod furniture;
mod ground;
mod houses;
mod lots;
mod materials;
mod meshes;
mod panels;
mod roofs;
mod shops;
mod terraces;
#[cfg(test)]
mod tests;
mod textures;
mod trees;
mod windows;

use super::parts::{self, Part};
use super::{Detail, place, sun};
use crate::scene::{Camera, Scene};
use glam::Vec3;
use materials::Palette;
use std::ops::RangeInclusive;

/// Half the length of the rows of houses along the street.
const HALF: f32 = 55.0;
/// Distance of the houses' fronts from the street's axis.
const FRONT: f32 = 8.0;
/// Depth of a house.
const DEPTH: f32 = 11.0;
/// Half the width of the carriageway, from kerb to kerb.
const ROAD: f32 = 4.8;
/// Height of the kerbs, and of the pavements behind them.
const KERB: f32 = 0.14;
/// Width of the cross streets from house to house, and of their pavements.
const CROSS: f32 = 12.0;
const WALK: f32 = 3.0;
/// Distance of the houses that end the cross streets from the street's axis.
const END: f32 = FRONT + DEPTH;
/// Length of a bay for parking, along the kerb. One has its middle at x = 0.
const BAY: f32 = 6.0;

/// Parameters of the built-in street.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Street {
    /// Drawn triangles, instances counted; met within 5 %, and clamped to [`Street::TRIANGLES`].
    pub triangles: u32,
    /// Seed of everything irregular: stones, leaves, curtains, how cars are parked.
    pub seed: u32,
}

impl Street {
    pub const TRIANGLES: RangeInclusive<u32> = 20_000..=2_000_000;
}

impl Default for Street {
    fn default() -> Self {
        Self { triangles: 260_000, seed: 0 }
    }
}

/// Parameters that parts are built from.
#[derive(Clone, Copy)]
struct Plan {
    detail: Detail,
    seed: u32,
    palette: Palette,
}

impl Plan {
    /// Longest side of the cells that flat surfaces are divided into.
    fn cell(&self) -> f32 {
        (1.6 / self.detail.0).clamp(0.05, 5.0)
    }

    /// The plan of one of many alike things. Their details differ a little, so that the number of triangles grows in small steps.
    fn of(&self, number: u32) -> Self {
        let factor = 0.86 + 0.28 * super::noise::unit(number, 3, 0x57);
        Self { detail: Detail(self.detail.0 * factor), ..*self }
    }
}

fn parts(plan: &Plan) -> Vec<Part> {
    parts::of_all(&[ground::parts, houses::parts, panels::parts, cars::parts, trees::parts, furniture::parts, terraces::parts], plan)
}

/// The street with the sun of day and its camera. The number of triangles is clamped to [`Street::TRIANGLES`].
pub fn street(knobs: &Street) -> Scene {
    let mut scene = Scene { name: "street".into(), ..Scene::default() };
    let palette = materials::add(&mut scene, knobs.seed);
    for part in parts_of_size(knobs, palette) {
        part.add_to(&mut scene);
    }
    scene.lights.push(sun(Vec3::new(0.34, -1.0, -0.62)));
    scene.cameras.push(Camera {
        name: "street".into(),
        position: Vec3::new(-47.0, 2.6, 1.6),
        target: Vec3::new(0.0, 5.2, 1.0),
        up: Vec3::Y,
        fov_y_deg: 58.0,
    });
    scene
}

fn parts_of_size(knobs: &Street, palette: Palette) -> Vec<Part> {
    let target = knobs.triangles.clamp(*Street::TRIANGLES.start(), *Street::TRIANGLES.end());
    parts::of_size(target, 300_000.0, |detail| parts(&Plan { detail, seed: knobs.seed, palette }))
}
