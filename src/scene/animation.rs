//! Scene animation: nodes that follow tracks, and the draws, lights and cameras attached to them.
//!
//! Nothing is precomputed. Every transform follows from the keys at the asked time alone.

use super::track::{EARLY, Track};
use super::{Aabb, Camera, Draw, Light, Scene};
use glam::{Affine3A, DAffine3, DQuat, DVec3, Vec3};
use std::borrow::Cow;

/// Moving nodes, and everything attached to them.
#[derive(Debug, Clone, PartialEq)]
pub struct Animation {
    /// Name in the file, for messages.
    pub name: String,
    /// Period, s; over 0.
    pub duration: f64,
    pub tracks: Vec<Track>,
    /// Nodes, parents before their children.
    pub nodes: Vec<MovingNode>,
    /// The scene's draws that move.
    pub draws: Vec<Hung>,
    /// The scene's lights that move.
    pub lights: Vec<Hung>,
    /// The scene's cameras that move.
    pub cameras: Vec<Hung>,
}

/// An attachment: `index` of the draw, light or camera in the scene, and `node` in [`Animation::nodes`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hung {
    pub index: usize,
    pub node: usize,
}

/// A node that moves, by its own tracks or with its parent.
#[derive(Debug, Clone, PartialEq)]
pub struct MovingNode {
    pub parent: Parent,
    pub local: Local,
}

/// Parent of a moving node.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Parent {
    /// World transform of a parent that does not move.
    Still(DAffine3),
    /// Index of a moving node.
    Moving(usize),
}

/// Transform relative to the parent, in double precision so that deep hierarchies do not drift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Local {
    Still(DAffine3),
    /// A part without a track in [`Animation::tracks`] is constant.
    Moving {
        translation: DVec3,
        rotation: DQuat,
        scale: DVec3,
        translation_track: Option<usize>,
        rotation_track: Option<usize>,
        scale_track: Option<usize>,
    },
}

impl Animation {
    /// World transform of every node, at any time.
    pub fn worlds(&self, seconds: f64) -> Vec<DAffine3> {
        let now = self.within(seconds);
        let mut worlds: Vec<DAffine3> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            worlds.push(self.world(node, &worlds, now));
        }
        worlds
    }

    /// World transform of one node at a time within the period. `before` are those of the nodes before it.
    pub fn world(&self, node: &MovingNode, before: &[DAffine3], now: f64) -> DAffine3 {
        let parent = match node.parent {
            Parent::Still(world) => world,
            Parent::Moving(parent) => before[parent],
        };
        parent * self.local(&node.local, now)
    }

    /// Number of a track of morph target weights, at any time.
    pub fn number(&self, track: usize, seconds: f64) -> f64 {
        self.tracks[track].vector(self.within(seconds)).x
    }

    /// Whether anything moves: the period is over 0 and something is attached.
    pub fn moves(&self) -> bool {
        self.duration > 0.0 && !(self.draws.is_empty() && self.lights.is_empty() && self.cameras.is_empty())
    }

    fn local(&self, local: &Local, now: f64) -> DAffine3 {
        match *local {
            Local::Still(affine) => affine,
            Local::Moving { translation, rotation, scale, translation_track, rotation_track, scale_track } => {
                let vector = |track: Option<usize>, still: DVec3| track.map_or(still, |track| self.tracks[track].vector(now));
                let rotation = rotation_track.map_or(rotation, |track| self.tracks[track].rotation(now));
                DAffine3::from_scale_rotation_translation(vector(scale_track, scale), rotation, vector(translation_track, translation))
            }
        }
    }

    /// Time within the period. No frame shows both the end of the animation and its beginning.
    fn within(&self, seconds: f64) -> f64 {
        let now = if self.duration > 0.0 { seconds.rem_euclid(self.duration) } else { 0.0 };
        if self.duration - now < EARLY { 0.0 } else { now }
    }

    /// Times at which extents are sampled: every key, and three steps between neighbouring keys. Animations with very many keys
    /// are subsampled evenly.
    pub fn samples(&self) -> Vec<f64> {
        let mut keys: Vec<f32> = self.tracks.iter().flat_map(|track| track.times()).copied().collect();
        keys.sort_by(f32::total_cmp);
        keys.dedup();
        let most = ((1 << 22) / (self.nodes.len() + self.draws.len()).max(1)).clamp(16, 4096);
        let every = keys.len().div_ceil(most / 4).max(1);
        let keys: Vec<f64> = keys.into_iter().step_by(every).map(f64::from).chain([self.duration - 2.0 * EARLY]).collect();
        let between = keys.windows(2).flat_map(|pair| [0.25, 0.5, 0.75].map(|s| pair[0] + (pair[1] - pair[0]) * s));
        keys.iter().copied().chain(between).filter(|time| *time >= 0.0).collect()
    }
}

/// Transform in single precision, as draws have it. A transform beyond its range becomes zero, which draws nothing.
pub fn single(world: DAffine3) -> Affine3A {
    let single = Affine3A::from_mat3_translation(world.matrix3.as_mat3(), world.translation.as_vec3());
    if single.is_finite() { single } else { Affine3A::ZERO }
}

/// World direction of a node, normalized. For a node scaled to nothing it is `direction` itself.
fn axis(world: DAffine3, direction: DVec3) -> Vec3 {
    world.transform_vector3(direction).normalize_or(direction).as_vec3()
}

impl Light {
    /// Places the light at a node: it shines along the node's -Z.
    pub fn stand_at(&mut self, world: DAffine3) {
        let (to, towards) = (single(world).translation.into(), axis(world, DVec3::NEG_Z));
        match self {
            Self::Directional { direction, .. } => *direction = towards,
            Self::Spot { position, direction, .. } => (*position, *direction) = (to, towards),
            Self::Point { position, .. } => *position = to,
            Self::Environment { .. } => {}
        }
    }
}

impl Camera {
    /// Places the camera at a node: it looks along the node's -Z, and +Y is up.
    pub fn stand_at(&mut self, world: DAffine3) {
        self.position = single(world).translation.into();
        self.target = self.position + axis(world, DVec3::NEG_Z);
        self.up = axis(world, DVec3::Y);
    }
}

impl Scene {
    /// Moves everything animated to its place at a time.
    pub fn set_time(&mut self, seconds: f64) {
        self.pose(seconds);
        self.bend();
    }

    /// Moves everything but the vertices of meshes that bend: [`Scene::bend`] follows, or the device bends them.
    pub fn pose(&mut self, seconds: f64) {
        let animation = self.animation.as_ref();
        let worlds = animation.map(|animation| animation.worlds(seconds)).unwrap_or_default();
        if let Some(bending) = &mut self.bending {
            bending.pose = bending.pose_at(animation, &worlds, seconds);
        }
        let Some(animation) = animation else { return };
        for hung in &animation.draws {
            self.draws[hung.index].transform = single(worlds[hung.node]);
        }
        stand(&mut self.lights, &animation.lights, |light, node| light.stand_at(worlds[node]));
        stand(&mut self.cameras, &animation.cameras, |camera, node| camera.stand_at(worlds[node]));
    }

    /// The scene's lights at a time, independent of [`Scene::set_time`].
    pub fn lights_at(&self, seconds: f64) -> Cow<'_, [Light]> {
        match &self.animation {
            Some(animation) if !animation.lights.is_empty() => {
                let (mut lights, worlds) = (self.lights.clone(), animation.worlds(seconds));
                stand(&mut lights, &animation.lights, |light, node| light.stand_at(worlds[node]));
                lights.into()
            }
            _ => self.lights.as_slice().into(),
        }
    }

    /// The scene's cameras at a time, independent of [`Scene::set_time`].
    pub fn cameras_at(&self, seconds: f64) -> Cow<'_, [Camera]> {
        match &self.animation {
            Some(animation) if !animation.cameras.is_empty() => {
                let (mut cameras, worlds) = (self.cameras.clone(), animation.worlds(seconds));
                stand(&mut cameras, &animation.cameras, |camera, node| camera.stand_at(worlds[node]));
                cameras.into()
            }
            _ => self.cameras.as_slice().into(),
        }
    }

    /// Whether each draw moves or bends.
    pub fn moving_draws(&self) -> Vec<bool> {
        let bends = |draw: &Draw| self.bending.as_ref().is_some_and(|bending| bending.mesh_of(draw).is_some());
        let mut moving: Vec<bool> = self.draws.iter().map(bends).collect();
        self.animation.iter().flat_map(|animation| &animation.draws).for_each(|hung| moving[hung.index] = true);
        moving
    }

    /// Bounds of each draw that moves or bends over the whole animation, by the draw's index: the union of its own bounds, moved to
    /// all [`Animation::samples`].
    pub fn swept_bounds(&self) -> Vec<(usize, Aabb)> {
        let mut swept = self.moved_bounds();
        if let Some(bending) = &self.bending {
            swept.retain(|(index, _)| bending.mesh_of(&self.draws[*index]).is_none());
            swept.extend(self.bent_bounds());
        }
        swept
    }

    /// Bounds of the draws that move over the whole animation, as if no mesh bent.
    fn moved_bounds(&self) -> Vec<(usize, Aabb)> {
        let Some(animation) = &self.animation else { return Vec::new() };
        let own = |hung: &Hung| self.draw_bounds(&Draw { transform: Affine3A::IDENTITY, ..self.draws[hung.index].clone() });
        let own: Vec<Aabb> = animation.draws.iter().map(own).collect();
        let mut swept: Vec<(usize, Aabb)> = animation.draws.iter().map(|hung| (hung.index, Aabb::EMPTY)).collect();
        for seconds in animation.samples() {
            let worlds = animation.worlds(seconds);
            for ((hung, own), (_, swept)) in animation.draws.iter().zip(&own).zip(&mut swept) {
                *swept = swept.union(own.transformed(&single(worlds[hung.node])));
            }
        }
        swept
    }
}

fn stand<T>(all: &mut [T], hung: &[Hung], at: impl Fn(&mut T, usize)) {
    hung.iter().for_each(|hung| at(&mut all[hung.index], hung.node));
}
