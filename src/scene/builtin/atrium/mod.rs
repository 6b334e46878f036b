//! A two-storey colonnaded court: round columns and arches, vaulted galleries below and timbered ones above, drapes, orange
//! trees and a fountain, under an open sky.
//!
//! Every part is a function from a level of detail to meshes. [`atrium`] searches the level whose drawn triangles add up to the
//! number asked for. Measures shared by several parts are constants here.

mod arcade;
mod balustrade;
mod cloth;
mod column;
mod court;
mod gallery;
mod garden;
mod lantern;
mod materials;
mod plants;
mod roof;
#[cfg(test)]
mod tests;
mod textures;

use super::parts::{self, Part};
use super::{Detail, sun};
use crate::scene::{Camera, Scene};
use glam::{Affine3A, Quat, Vec3};
use materials::Palette;
use std::f32::consts::FRAC_PI_2;
use std::ops::RangeInclusive;

/// Distance of the columns' axes.
const PITCH: f32 = 3.0;
/// Bays of the long and of the short side.
const BAYS: [usize; 2] = [8, 3];
/// Half-lengths (x, z) of the rectangle of the columns' axes around the court.
const HALF: [f32; 2] = [PITCH * BAYS[0] as f32 / 2.0, PITCH * BAYS[1] as f32 / 2.0];
/// Half the thickness of the arcades' walls.
const WALL: f32 = 0.25;
/// Distance from the columns' axes to the inner face of the outer wall.
const DEPTH: f32 = 3.4;
/// Thickness of the outer wall.
const OUTER_WALL: f32 = 0.5;
/// Height of the lower gallery's floor above the court's.
const PLINTH: f32 = 0.16;
/// Heights of the arches' springing lines, the tops of the columns.
const SPRING: [f32; 2] = [3.25, 7.85];
/// Radii of the arches.
const RADIUS: [f32; 2] = [1.15, 1.24];
/// Height of the upper gallery's floor.
const UPPER: f32 = 5.15;
/// Height of the upper columns' feet: the pedestals' top, level with the handrail.
const RAIL: f32 = UPPER + 0.95;
/// Heights of the arcade walls' tops: under the string course and behind the cornice.
const WALL_TOP: [f32; 2] = [4.8, 9.6];
/// Height of the upper gallery's timber ceiling.
const CEILING: f32 = 9.3;
/// Height of the eaves, the top of the cornice.
const EAVES: f32 = 9.86;

/// Parameters of the built-in court.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Atrium {
    /// Drawn triangles, instances counted; met within 5 %, and clamped to [`Atrium::TRIANGLES`].
    pub triangles: u32,
    /// Seed of everything irregular: stones, folds, leaves.
    pub seed: u32,
}

impl Atrium {
    pub const TRIANGLES: RangeInclusive<u32> = 10_000..=8_000_000;
}

impl Default for Atrium {
    fn default() -> Self {
        Self { triangles: 260_000, seed: 0 }
    }
}

/// Parameters of the built-in courtyard: the court, planted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Courtyard {
    /// Drawn triangles, instances counted; met within 5 %, and clamped to [`Courtyard::TRIANGLES`]. A quarter of them, but no more than the
    /// court has by default, are the building's.
    pub triangles: u32,
    /// Seed of everything irregular.
    pub seed: u32,
}

impl Courtyard {
    pub const TRIANGLES: RangeInclusive<u32> = 100_000..=10_000_000;
}

/// Parameters that parts are built from.
struct Plan {
    detail: Detail,
    seed: u32,
    palette: Palette,
}

impl Plan {
    /// Size of the cells that flat surfaces are divided into.
    fn cell(&self) -> f32 {
        (0.75 / self.detail.0).clamp(0.05, 6.0)
    }
}

/// One side of the court in its own frame: x along the arcade, z into the court, the origin on the ground under the middle of
/// the columns' axis.
struct Side {
    frame: Affine3A,
    bays: usize,
}

impl Side {
    fn all() -> [Self; 4] {
        std::array::from_fn(|i| {
            let turn = Quat::from_rotation_y(-FRAC_PI_2 * i as f32);
            let out = [Vec3::NEG_Z * HALF[1], Vec3::X * HALF[0], Vec3::Z * HALF[1], Vec3::NEG_X * HALF[0]][i];
            Self { frame: Affine3A::from_rotation_translation(turn, out), bays: BAYS[i % 2] }
        })
    }

    /// Half the distance of the corner piers.
    fn half(&self) -> f32 {
        self.bays as f32 * PITCH / 2.0
    }

    fn bay_x(&self, bay: usize) -> f32 {
        (bay as f32 + 0.5) * PITCH - self.half()
    }

    fn bay(&self, bay: usize) -> Affine3A {
        self.frame * Affine3A::from_translation(Vec3::X * self.bay_x(bay))
    }

    fn bays(&self) -> impl Iterator<Item = Affine3A> + '_ {
        (0..self.bays).map(|bay| self.bay(bay))
    }

    /// Frames of the columns between the corner piers.
    fn columns(&self) -> impl Iterator<Item = Affine3A> + '_ {
        (1..self.bays).map(|i| self.frame * Affine3A::from_translation(Vec3::X * (i as f32 * PITCH - self.half())))
    }
}

/// Frames of every bay of all four sides.
fn all_bays() -> Vec<Affine3A> {
    Side::all().iter().flat_map(|side| side.bays().collect::<Vec<_>>()).collect()
}

/// Frames of every round column, on the court's floor.
fn all_columns() -> Vec<Affine3A> {
    Side::all().iter().flat_map(|side| side.columns().collect::<Vec<_>>()).collect()
}

/// Frames of the corner piers; x and z point to the court.
fn corners() -> [Affine3A; 4] {
    std::array::from_fn(|i| {
        let turn = Quat::from_rotation_y(-FRAC_PI_2 * i as f32);
        let signs = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]][i];
        Affine3A::from_rotation_translation(turn, Vec3::new(signs[0] * HALF[0], 0.0, signs[1] * HALF[1]))
    })
}

fn parts(plan: &Plan) -> Vec<Part> {
    let makers: &[fn(&Plan) -> Vec<Part>] = &[
        arcade::parts,
        column::parts,
        balustrade::parts,
        gallery::parts,
        roof::parts,
        court::parts,
        cloth::parts,
        plants::parts,
        lantern::parts,
    ];
    parts::of_all(makers, plan)
}

/// The court with its sun and its camera. The number of triangles is clamped to [`Atrium::TRIANGLES`].
pub fn atrium(knobs: &Atrium) -> Scene {
    let mut scene = Scene { name: "atrium".into(), ..Scene::default() };
    let palette = materials::add(&mut scene, knobs.seed);
    finished(scene, &parts_of_size(knobs, palette))
}

/// The court with trees, shrubs, ivy, ferns, and laid tables. The number of triangles is clamped to [`Courtyard::TRIANGLES`].
pub fn courtyard(knobs: &Courtyard) -> Scene {
    let target = knobs.triangles.clamp(*Courtyard::TRIANGLES.start(), *Courtyard::TRIANGLES.end());
    let building = Atrium { triangles: (target / 4).min(Atrium::default().triangles), seed: knobs.seed };
    let mut scene = Scene { name: "courtyard".into(), ..Scene::default() };
    let palette = materials::add(&mut scene, knobs.seed);
    let greens = garden::Greens::add(&mut scene);
    let mut all = parts_of_size(&building, palette);
    let rest = target - all.iter().map(Part::triangles).sum::<usize>() as u32;
    all.extend(parts::of_size(rest, 2_000_000.0, |detail| {
        garden::parts(&garden::GardenPlan { detail, seed: knobs.seed, palette, greens })
    }));
    finished(scene, &all)
}

/// A scene of these parts, with the sun and the camera.
fn finished(mut scene: Scene, parts: &[Part]) -> Scene {
    parts.iter().for_each(|part| part.add_to(&mut scene));
    scene.lights.push(sun(Vec3::new(0.34, -1.0, 0.25)));
    scene.cameras.push(Camera {
        name: "court".into(),
        position: Vec3::new(-11.3, 2.2, 0.9),
        target: Vec3::new(6.0, 3.2, -1.0),
        up: Vec3::Y,
        fov_y_deg: 60.0,
    });
    scene
}

fn parts_of_size(knobs: &Atrium, palette: Palette) -> Vec<Part> {
    let target = knobs.triangles.clamp(*Atrium::TRIANGLES.start(), *Atrium::TRIANGLES.end());
    parts::of_size(target, 420_000.0, |detail| parts(&Plan { detail, seed: knobs.seed, palette }))
}
