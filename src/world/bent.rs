//! Meshes that bend, on the device: the inputs of `glsl/deform/vertices.comp`.
//!
//! Vertices as modelled, influences and displacements lie in images, since a software driver loads a texel at once but a storage buffer
//! word by word.

use super::word_image::WordImage;
use crate::fail;
use crate::gpu::{BufferId, Gpu};
use crate::graph::{Buffer, Graph, Image};
use crate::scene::Scene;
use crate::scene::bend::{Bending, BentMesh, Pose};
use crate::shader_struct;
use anyhow::Result;
use std::collections::HashMap;

shader_struct! {
    /// Vertices of one mesh for one workgroup; `glsl/deform/vertices.comp` says what its members are.
    pub struct Run {
        pub first: u32,
        pub count: u32,
        pub within: u32,
        pub rest: u32,
        pub tangents: u32,
        pub matrices: u32,
        pub influences: u32,
        pub fours: u32,
        pub targets: u32,
    }
}

/// Vertices of a run, at most: the workgroup's size.
const RUN: u32 = 64;
/// Texels of a row of the pose's image.
pub const POSE_COLUMNS: u32 = 1024;

/// Meshes that bend, on the device, which owns the images and buffers.
pub struct DeviceBending {
    rest: WordImage,
    influences: WordImage,
    deltas: WordImage,
    runs: (BufferId, u32),
    targets: Vec<Targets>,
    /// The pose of the next frame, in texels.
    pose: Vec<[u32; 4]>,
}

/// A mesh's displacements.
#[derive(Debug, Clone, Copy, Default)]
struct Targets {
    /// First texel of the first target.
    first: u32,
    /// Texels of a vertex: 2 if normals are displaced.
    texels: u32,
    /// Texels of a target.
    each: u32,
}

/// The meshes in one frame's graph.
#[derive(Debug, Clone, Copy)]
pub struct FrameBending {
    pub rest: Image,
    pub influences: Image,
    pub deltas: Image,
    /// [`Run`] of each workgroup.
    pub runs: Buffer,
    /// Texels of the pose, in whole rows of [`POSE_COLUMNS`].
    pub pose: Buffer,
}

impl DeviceBending {
    /// Uploads the meshes of a scene that bend.
    ///
    /// # Errors
    /// `BadInput` if they are over a limit of the device.
    pub fn upload(gpu: &mut Gpu, scene: &Scene, bending: &Bending) -> Result<Self> {
        let limits = gpu.adapter.limits;
        let bytes = size_of_val(scene.vertices.as_slice()) as u64;
        if bytes > limits.storage_buffer_bytes {
            return Err(fail!(
                BadInput,
                "{}: meshes in it bend, so a shader must see all of its {} MB of vertices, over the {} MB that {} allows; take a smaller \
                 file, or hold it still with scene.animation = \"none\"",
                scene.name,
                bytes >> 20,
                limits.storage_buffer_bytes >> 20,
                gpu.adapter.name
            ));
        }
        let (rest, rest_texels) = rest_words(bending);
        let (deltas, targets) = delta_words(bending);
        let mut runs = Vec::new();
        for (number, mesh) in bending.meshes.iter().enumerate() {
            let (rest, tangents) = rest_texels[&mesh.rest];
            let texels = 1 + u32::from(tangents);
            let run = |within: u32| Run {
                first: mesh.first + within,
                count: (mesh.count - within).min(RUN),
                within,
                rest: rest + within * texels,
                tangents: u32::from(tangents),
                matrices: mesh.skin.map_or(0, |skin| 3 * skin.joints),
                influences: mesh.skin.map_or(0, |skin| skin.influences + within * skin.fours),
                fours: mesh.skin.map_or(0, |skin| skin.fours),
                targets: (3 * bending.joints.len() + number) as u32,
            };
            runs.extend((0..mesh.count).step_by(RUN as usize).map(run));
        }
        let upload = |gpu: &mut Gpu, name: &'static str, words: &[u32]| WordImage::upload(gpu, &scene.name, name, words);
        let mut made = Self {
            rest: upload(gpu, "scene/rest", &rest)?,
            influences: upload(gpu, "scene/influences", bytemuck::cast_slice(&bending.influences))?,
            deltas: upload(gpu, "scene/deltas", &deltas)?,
            runs: (gpu.create_filled_buffer("scene/runs", bytemuck::cast_slice(&runs))?, runs.len() as u32),
            targets,
            pose: Vec::new(),
        };
        made.follow(&bending.pose);
        Ok(made)
    }

    /// Takes over a pose: three rows a matrix, and each mesh's list of targets with a weight.
    pub fn follow(&mut self, pose: &Pose) {
        self.pose.clear();
        for matrix in &pose.matrices {
            let (linear, translation) = (matrix.matrix3.transpose(), matrix.translation);
            let row = |axis: glam::Vec3A, shift: f32| [axis.x, axis.y, axis.z, shift].map(f32::to_bits);
            let rows = [(linear.x_axis, translation.x), (linear.y_axis, translation.y), (linear.z_axis, translation.z)];
            self.pose.extend(rows.map(|(axis, shift)| row(axis, shift)));
        }
        let mut listed = (self.pose.len() + pose.weights.len()) as u32;
        let mut lists = Vec::new();
        for (weights, targets) in pose.weights.iter().zip(&self.targets) {
            let used = weights.iter().zip(0..).filter(|(weight, _)| **weight != 0.0);
            let list: Vec<[u32; 4]> =
                used.map(|(weight, target)| [targets.first + target * targets.each, weight.to_bits(), 0, 0]).collect();
            self.pose.push([listed, list.len() as u32, targets.texels, 0]);
            listed += list.len() as u32;
            lists.extend(list);
        }
        self.pose.extend(lists);
        self.pose.resize(self.pose.len().next_multiple_of(POSE_COLUMNS as usize), [0; 4]);
    }

    /// Imports the meshes into a frame's graph.
    pub fn import(&self, g: &mut Graph) -> FrameBending {
        FrameBending {
            rest: self.rest.import(g),
            influences: self.influences.import(g),
            deltas: self.deltas.import(g),
            runs: g.import_buffer::<Run>("scene/runs", self.runs.0, self.runs.1),
            pose: g.upload("scene/pose", &self.pose),
        }
    }
}

/// Texels of the vertices as modelled. The map has each range's first texel, and whether its tangents follow.
fn rest_words(bending: &Bending) -> (Vec<u32>, HashMap<u32, (u32, bool)>) {
    let (mut words, mut places) = (Vec::new(), HashMap::new());
    for mesh in &bending.meshes {
        places.entry(mesh.rest).or_insert_with(|| {
            let vertices = &bending.rest[mesh.rest as usize..][..mesh.count as usize];
            let (first, tangents) = (words.len() as u32 / 4, vertices.iter().any(|vertex| vertex.tangent != 0));
            for vertex in vertices {
                words.extend(vertex.position.map(f32::to_bits));
                words.push(vertex.normal);
                if tangents {
                    words.extend([vertex.tangent, 0, 0, 0]);
                }
            }
            (first, tangents)
        });
    }
    (words, places)
}

/// Texels of the displacements, and where each mesh has its own.
fn delta_words(bending: &Bending) -> (Vec<u32>, Vec<Targets>) {
    let (mut words, mut places) = (Vec::new(), HashMap::new());
    let mut place = |mesh: &BentMesh| {
        let Some(morph) = &mesh.morph else { return Targets::default() };
        *places.entry(morph.deltas).or_insert_with(|| {
            let first = words.len() as u32 / 4;
            let count = morph.weights.len() * mesh.count as usize;
            for delta in &bending.deltas[morph.deltas as usize..][..count] {
                for shift in std::iter::once(delta.position).chain(morph.normals.then_some(delta.normal)) {
                    words.extend(shift.map(f32::to_bits));
                    words.push(0);
                }
            }
            let texels = 1 + u32::from(morph.normals);
            Targets { first, texels, each: texels * mesh.count }
        })
    };
    let targets = bending.meshes.iter().map(&mut place).collect();
    (words, targets)
}
