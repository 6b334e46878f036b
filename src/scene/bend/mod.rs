//! Meshes that bend: morph targets, then skins (glTF 2.0, sections 3.7.2.2 and 3.7.3).
//!
//! A vertex at p, with displacements d_k of its targets, weights w_k, joint matrices M_j and influences a_j, is bent to
//! (sum a_j M_j) (p + sum w_k d_k). Its normal is displaced as well, and multiplied by the cofactors of sum a_j M_j.
//! `glsl/deform/vertices.comp` is the same on the device.

mod reach;

pub use reach::Reach;

use super::animation::{Animation, Parent, single};
use super::{Draw, Scene, Vertex, pack};
use glam::{Affine3A, DAffine3, DMat3, DVec3, Mat3, Vec3};
use rayon::prelude::*;

/// All meshes that bend, as they were modelled, and their pose.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bending {
    /// Vertices as modelled; meshes may share them.
    pub rest: Vec<Vertex>,
    /// Influences of joints on the vertices as modelled; one or two elements a vertex.
    pub influences: Vec<Influences>,
    /// Displacements of the vertices as modelled, one target after the other.
    pub deltas: Vec<Delta>,
    /// Joints of all skins, one skin after the other.
    pub joints: Vec<Joint>,
    /// Meshes in the order of their vertices.
    pub meshes: Vec<BentMesh>,
    /// The pose at the scene's present time.
    pub pose: Pose,
}

/// Influences of four joints on a vertex: 16 bytes, a texel on the device, which takes them as words.
#[repr(C, align(4))]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Influences {
    /// Numbers of the joints in their skin.
    pub joints: [u16; 4],
    /// Weights, unsigned normalized. All weights of a vertex sum to 65535.
    pub weights: [u16; 4],
}

/// Displacement of a vertex by a morph target of weight 1.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Delta {
    pub position: [f32; 3],
    pub normal: [f32; 3],
}

/// A joint of a skin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// World transform of the joint's node, or the moving node.
    pub node: Parent,
    /// Transform from the mesh as modelled to the joint's space.
    pub inverse_bind: DAffine3,
}

/// A range of the scene's vertices that bends. A mesh with a skin is bent in world space, and its draws have no transform.
#[derive(Debug, Clone, PartialEq)]
pub struct BentMesh {
    /// Range in [`Scene::vertices`]. The mesh's draws, and no others, have `first` as their vertex offset.
    pub first: u32,
    pub count: u32,
    /// First of its vertices in [`Bending::rest`].
    pub rest: u32,
    pub skin: Option<Skinning>,
    pub morph: Option<Morph>,
}

/// A mesh's use of a skin.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Skinning {
    /// First of the skin's joints in [`Bending::joints`].
    pub joints: u32,
    /// First of the mesh's elements in [`Bending::influences`].
    pub influences: u32,
    /// Elements a vertex: 1 or 2.
    pub fours: u32,
}

/// A mesh's morph targets.
#[derive(Debug, Clone, PartialEq)]
pub struct Morph {
    /// First of the mesh's elements in [`Bending::deltas`]: `count` a target.
    pub deltas: u32,
    /// Whether any target displaces normals.
    pub normals: bool,
    /// Weight of each target.
    pub weights: Vec<Weight>,
}

/// Weight of a morph target.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weight {
    Still(f32),
    /// Index of a track of the scene's animation.
    Moving(usize),
}

/// Joints and weights at one time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Pose {
    /// Matrix of each joint: from the mesh as modelled to the world.
    pub matrices: Vec<Affine3A>,
    /// Weights of each mesh's targets.
    pub weights: Vec<Vec<f32>>,
}

impl Bending {
    /// The mesh that a draw shows, if it bends.
    pub fn mesh_of(&self, draw: &Draw) -> Option<usize> {
        self.meshes.binary_search_by_key(&draw.vertex_offset, |mesh| mesh.first).ok()
    }

    /// Whether a mesh whose vertices begin at `offset` bends.
    pub fn has(&self, offset: u32) -> bool {
        self.meshes.binary_search_by_key(&offset, |mesh| mesh.first).is_ok()
    }

    /// Whether the animation changes a mesh's shape.
    fn moves(&self, mesh: &BentMesh) -> bool {
        let joints = mesh.skin.iter().flat_map(|skin| self.joints_of(mesh, *skin));
        let weights = mesh.morph.iter().flat_map(|morph| &morph.weights);
        joints.into_iter().any(|joint| matches!(self.joints[joint].node, Parent::Moving(_)))
            || weights.into_iter().any(|weight| matches!(weight, Weight::Moving(_)))
    }

    /// Joints that influence a mesh, as indices into [`Bending::joints`], with repetitions.
    fn joints_of(&self, mesh: &BentMesh, skin: Skinning) -> impl Iterator<Item = usize> + use<'_> {
        let influences = &self.influences[skin.influences as usize..][..(mesh.count * skin.fours) as usize];
        influences
            .iter()
            .flat_map(|four| four.joints.into_iter().zip(four.weights))
            .filter_map(move |(joint, weight)| (weight > 0).then_some(skin.joints as usize + joint as usize))
    }

    /// Pose at a time of the animation, given its nodes' world transforms then. Without an animation nothing moves.
    pub(super) fn pose_at(&self, animation: Option<&Animation>, worlds: &[DAffine3], seconds: f64) -> Pose {
        let matrix = |joint: &Joint| {
            let world = match joint.node {
                Parent::Still(world) => world,
                Parent::Moving(node) => worlds[node],
            };
            single(world * joint.inverse_bind)
        };
        let weight = |weight: &Weight| match (*weight, animation) {
            (Weight::Still(weight), _) => weight,
            (Weight::Moving(track), Some(animation)) => animation.number(track, seconds) as f32,
            (Weight::Moving(_), None) => unreachable!("a track is of an animation"),
        };
        let weights = |mesh: &BentMesh| mesh.morph.iter().flat_map(|morph| &morph.weights).map(weight).collect();
        Pose { matrices: self.joints.iter().map(matrix).collect(), weights: self.meshes.iter().map(weights).collect() }
    }

    /// Vertex `i` of mesh `number` in the present pose, computed in double precision.
    fn bent(&self, number: usize, i: usize) -> Vertex {
        let mesh = &self.meshes[number];
        let rest = &self.rest[mesh.rest as usize + i];
        let unbent = pack::octahedral_snorm16_inverse(rest.normal).as_dvec3();
        let (mut position, mut normal) = (Vec3::from(rest.position).as_dvec3(), unbent);
        if let Some(morph) = &mesh.morph {
            for (target, weight) in self.pose.weights[number].iter().enumerate() {
                let delta = &self.deltas[morph.deltas as usize + target * mesh.count as usize + i];
                position += Vec3::from(delta.position).as_dvec3() * f64::from(*weight);
                normal += Vec3::from(delta.normal).as_dvec3() * f64::from(*weight);
            }
        }
        let mut tangent = rest.tangent;
        if let Some(skin) = mesh.skin {
            let mut linear = DMat3::ZERO;
            let mut translation = DVec3::ZERO;
            for four in &self.influences[skin.influences as usize + i * skin.fours as usize..][..skin.fours as usize] {
                for (joint, weight) in four.joints.into_iter().zip(four.weights) {
                    let matrix = &self.pose.matrices[skin.joints as usize + joint as usize];
                    let weight = f64::from(weight) / 65535.0;
                    linear += Mat3::from(matrix.matrix3).as_dmat3() * weight;
                    translation += Vec3::from(matrix.translation).as_dvec3() * weight;
                }
            }
            position = linear * position + translation;
            let cofactors = DMat3::from_cols(
                linear.y_axis.cross(linear.z_axis),
                linear.z_axis.cross(linear.x_axis),
                linear.x_axis.cross(linear.y_axis),
            );
            let orientation = if linear.x_axis.dot(cofactors.x_axis) < 0.0 { -1.0 } else { 1.0 };
            normal = cofactors * normal * orientation;
            if tangent != 0 {
                let (direction, handedness) = pack::tangent_inverse(tangent);
                let direction = (linear * direction.as_dvec3()).try_normalize().map_or(direction, |direction| direction.as_vec3());
                tangent = pack::tangent(direction, handedness);
            }
        }
        let normal = pack::octahedral_snorm16(normal.try_normalize().unwrap_or(unbent).as_vec3());
        Vertex { position: position.as_vec3().into(), normal, tangent, ..*rest }
    }
}

impl Scene {
    /// Bends the vertices to the present pose. [`Scene::set_time`] does it too.
    pub fn bend(&mut self) {
        let Some(bending) = &self.bending else { return };
        for (number, mesh) in bending.meshes.iter().enumerate() {
            let vertices = &mut self.vertices[mesh.first as usize..][..mesh.count as usize];
            vertices.par_iter_mut().enumerate().for_each(|(i, vertex)| *vertex = bending.bent(number, i));
        }
    }

    /// Bends all vertices once, and forgets the meshes whose shape the animation does not change.
    pub fn bake(&mut self) {
        self.bend();
        let Some(mut bending) = self.bending.take() else { return };
        let plays = self.animation.as_ref().is_some_and(|animation| animation.duration > 0.0);
        let moves: Vec<bool> = bending.meshes.iter().map(|mesh| plays && bending.moves(mesh)).collect();
        for_moving(&mut bending.meshes, &moves);
        for_moving(&mut bending.pose.weights, &moves);
        self.bending = (!bending.meshes.is_empty()).then_some(bending);
    }
}

fn for_moving<T>(all: &mut Vec<T>, moves: &[bool]) {
    let mut moves = moves.iter();
    all.retain(|_| moves.next() == Some(&true));
}
