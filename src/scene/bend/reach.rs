//! Bounds of meshes that bend, without bending a vertex.
//!
//! A bent vertex is a mean of its images by the joints that influence it. So a box around the images of each joint's vertices holds it.

use super::{Bending, BentMesh, Pose};
use crate::scene::animation::{Animation, single};
use crate::scene::{Aabb, Draw, Scene};
use glam::{Affine3A, Vec3};
use std::collections::{BTreeMap, HashMap};

/// Relative error of a position that is bent in single precision, with room.
const ROUNDING: f32 = 4e-6;

/// Boxes from which the bounds of a draw's triangles follow in any pose.
#[derive(Debug, Clone)]
pub struct Reach {
    /// The mesh's number in [`Bending::meshes`].
    mesh: usize,
    /// Joints, as indices into [`Bending::joints`], and boxes of the vertices that each influences. A mesh without a skin has one box.
    boxes: Vec<(Option<usize>, Aabb)>,
    /// Box of each target's displacements.
    targets: Vec<Aabb>,
}

impl Reach {
    fn of(bending: &Bending, number: usize, mesh: &BentMesh, indices: &[u32]) -> Self {
        let mut boxes: BTreeMap<Option<usize>, Aabb> = BTreeMap::new();
        let targets = mesh.morph.as_ref().map_or(0, |morph| morph.weights.len());
        let mut targets = vec![Aabb::EMPTY; targets];
        let mut add = |joint: Option<usize>, position: Vec3| {
            let held = boxes.entry(joint).or_insert(Aabb::EMPTY);
            *held = held.union(Aabb::of([position]));
        };
        for i in indices.iter().map(|i| *i as usize) {
            let position = Vec3::from(bending.rest[mesh.rest as usize + i].position);
            match mesh.skin {
                None => add(None, position),
                Some(skin) => {
                    let fours = &bending.influences[skin.influences as usize + i * skin.fours as usize..][..skin.fours as usize];
                    let influences = fours.iter().flat_map(|four| four.joints.into_iter().zip(four.weights));
                    for (joint, _) in influences.filter(|(_, weight)| *weight > 0) {
                        add(Some(skin.joints as usize + joint as usize), position);
                    }
                }
            }
            for (target, held) in targets.iter_mut().enumerate() {
                let deltas = mesh.morph.as_ref().map_or(0, |morph| morph.deltas as usize);
                *held = held.union(Aabb::of([bending.deltas[deltas + target * mesh.count as usize + i].position.into()]));
            }
        }
        Self { mesh: number, boxes: boxes.into_iter().collect(), targets }
    }

    /// World-space bounds in a pose. `transform` is the draw's.
    pub fn bounds(&self, pose: &Pose, transform: &Affine3A) -> Aabb {
        let zero = Aabb { min: Vec3::ZERO, max: Vec3::ZERO };
        let displaced = self.targets.iter().zip(&pose.weights[self.mesh]).fold(zero, |sum, (held, weight)| {
            let (a, b) = (held.min * *weight, held.max * *weight);
            Aabb { min: sum.min + a.min(b), max: sum.max + a.max(b) }
        });
        let image = |(joint, held): &(Option<usize>, Aabb)| {
            let whole = Aabb { min: held.min + displaced.min, max: held.max + displaced.max };
            let matrix = joint.map_or(transform, |joint| &pose.matrices[joint]);
            let most = whole.min.abs().max(whole.max.abs());
            let linear = [matrix.matrix3.x_axis, matrix.matrix3.y_axis, matrix.matrix3.z_axis].map(|axis| Vec3::from(axis.abs()));
            let reach = linear[0] * most.x + linear[1] * most.y + linear[2] * most.z + Vec3::from(matrix.translation.abs());
            let image = whole.transformed(matrix);
            Aabb { min: image.min - reach * ROUNDING, max: image.max + reach * ROUNDING }
        };
        self.boxes.iter().map(image).fold(Aabb::EMPTY, Aabb::union)
    }

    /// Boxes that [`Self::bounds`] goes through.
    fn len(&self) -> usize {
        self.boxes.len() + self.targets.len()
    }
}

impl Scene {
    /// Reach of a draw, or of a part of one; `None` if it does not bend.
    pub fn reach(&self, draw: &Draw) -> Option<Reach> {
        let bending = self.bending.as_ref()?;
        let number = bending.mesh_of(draw)?;
        let indices = &self.indices[draw.first_index as usize..(draw.first_index + draw.index_count) as usize];
        Some(Reach::of(bending, number, &bending.meshes[number], indices))
    }

    /// Bounds of each draw that bends over the whole animation, by the draw's index: the union over all of the animation's samples.
    pub(in crate::scene) fn bent_bounds(&self) -> Vec<(usize, Aabb)> {
        /// Times that are sampled besides the animation's own samples.
        const EVENLY: u32 = 256;
        /// Boxes that are transformed, at most.
        const MOST: usize = 1 << 23;
        let Some(bending) = &self.bending else { return Vec::new() };
        let hung: HashMap<usize, usize> =
            self.animation.iter().flat_map(|animation| &animation.draws).map(|hung| (hung.index, hung.node)).collect();
        let reaches: Vec<(usize, Reach)> =
            self.draws.iter().enumerate().filter_map(|(index, draw)| Some((index, self.reach(draw)?))).collect();
        let mut swept: Vec<(usize, Aabb)> = reaches.iter().map(|(index, _)| (*index, Aabb::EMPTY)).collect();
        let boxes = reaches.iter().map(|(_, reach)| reach.len()).sum::<usize>() + bending.joints.len();
        let mut samples = self.animation.as_ref().map_or_else(|| vec![0.0], Animation::samples);
        // A chain of joints goes farther between two keys than each joint does.
        let duration = self.animation.as_ref().map_or(0.0, |animation| animation.duration);
        samples.extend((0..EVENLY).map(|i| duration * f64::from(i) / f64::from(EVENLY)));
        samples.sort_by(f64::total_cmp);
        let every = samples.len().div_ceil((MOST / boxes.max(1)).max(16));
        for seconds in samples.into_iter().step_by(every) {
            let worlds = self.animation.as_ref().map(|animation| animation.worlds(seconds)).unwrap_or_default();
            let pose = bending.pose_at(self.animation.as_ref(), &worlds, seconds);
            for ((index, reach), (_, swept)) in reaches.iter().zip(&mut swept) {
                let transform = hung.get(index).map_or(self.draws[*index].transform, |node| single(worlds[*node]));
                *swept = swept.union(reach.bounds(&pose, &transform));
            }
        }
        swept
    }
}
