//! Skins of a file: their joints and inverse bind matrices.

use super::accessors::Attribute;
use super::nodes::Placed;
use super::{File, label, refuse};
use crate::scene::animation::Parent;
use crate::scene::bend::Joint;
use anyhow::{Context, Result};
use glam::{DAffine3, DMat4};
use gltf_json::{Index, Skin};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// Limit of the joints of all skins: their matrices are computed and uploaded every frame.
const MAX_JOINTS: usize = 1 << 16;

/// A skin's joints.
#[derive(Debug, Clone, Copy)]
pub struct Joints {
    /// First of them among those of all skins.
    pub first: u32,
    pub count: u32,
    /// Whether the joints mirror what they bend, at the animation's time 0.
    mirrored: bool,
}

/// The skins that the scene's meshes use.
#[derive(Debug, Default)]
pub struct Skins {
    pub joints: Vec<Joint>,
    skins: HashMap<usize, Joints>,
}

impl Skins {
    /// Joints of a skin that a placed mesh has.
    pub fn get(&self, skin: Index<Skin>) -> Joints {
        self.skins[&skin.value()]
    }
}

/// Reads the skins of the placed meshes, and finds out which of these are mirrored.
pub fn read(file: &File<'_>, placed: &mut Placed) -> Result<Skins> {
    let mut skins = Skins::default();
    let worlds = placed.animation.as_ref().map(|animation| animation.worlds(0.0)).unwrap_or_default();
    for mesh in &mut placed.meshes {
        let Some(index) = mesh.skin else { continue };
        let skin = file.get(index, "skin").with_context(|| format!("node {}", mesh.node))?;
        if let Entry::Vacant(entry) = skins.skins.entry(index.value()) {
            let first = skins.joints.len();
            read_joints(file, skin, &placed.nodes, &mut skins.joints).with_context(|| label("skin", index.value(), skin.name.as_ref()))?;
            let joints = &skins.joints[first..];
            let mirrors = |joint: &&Joint| {
                let world = match joint.node {
                    Parent::Still(world) => world,
                    Parent::Moving(node) => worlds[node],
                };
                (world * joint.inverse_bind).matrix3.determinant() < 0.0
            };
            let mirrored = 2 * joints.iter().filter(mirrors).count() > joints.len();
            entry.insert(Joints { first: first as u32, count: joints.len() as u32, mirrored });
        }
        mesh.mirrored = skins.skins[&index.value()].mirrored;
    }
    Ok(skins)
}

fn read_joints(file: &File<'_>, skin: &Skin, nodes: &[Option<Parent>], joints: &mut Vec<Joint>) -> Result<()> {
    if skin.joints.is_empty() {
        refuse!("it has no joints");
    }
    if joints.len() + skin.joints.len() > MAX_JOINTS {
        refuse!("with it, the scene's skins have more than {MAX_JOINTS} joints");
    }
    if let Some(skeleton) = skin.skeleton {
        file.get(skeleton, "node").context("its skeleton")?;
    }
    let matrices: Vec<[f32; 16]> = match skin.inverse_bind_matrices {
        Some(accessor) => file.floats(accessor, Attribute::InverseBind)?,
        None => vec![DMat4::IDENTITY.as_mat4().to_cols_array(); skin.joints.len()],
    };
    if matrices.len() < skin.joints.len() {
        refuse!("its {} joints have only {} inverseBindMatrices", skin.joints.len(), matrices.len());
    }
    for (i, (index, matrix)) in skin.joints.iter().zip(&matrices).enumerate() {
        file.get(*index, "node").with_context(|| format!("joint {i}"))?;
        let Some(node) = nodes[index.value()] else {
            refuse!("its joint {i} is node {index}, which is not in the scene");
        };
        let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
        if (matrix.row(3) - DMat4::IDENTITY.row(3)).abs().max_element() > 1e-4 {
            refuse!("the last row of the inverseBindMatrices' element {i} is {}, it must be 0 0 0 1", matrix.row(3));
        }
        joints.push(Joint { node, inverse_bind: DAffine3::from_mat4(matrix) });
    }
    Ok(())
}
