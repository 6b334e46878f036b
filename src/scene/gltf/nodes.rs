//! The node hierarchy: which meshes, lights and cameras stand where.

use super::{File, SceneChoice, Warning, Warnings, label, lights, refuse};
use crate::scene::{Camera, Light};
use anyhow::{Context, Result};
use glam::{Affine3A, DAffine3, DMat3, DMat4, DQuat, DVec3};
use gltf_json::{Index, Mesh, Node};

/// What a scene's nodes place in the world.
pub struct Placed {
    pub meshes: Vec<PlacedMesh>,
    pub lights: Vec<Light>,
    pub cameras: Vec<Camera>,
}

/// A mesh at a node.
pub struct PlacedMesh {
    pub mesh: Index<Mesh>,
    /// For messages.
    pub node: usize,
    pub transform: Affine3A,
    /// The transform turns left hands into right ones, and with them the order of a triangle's corners.
    pub mirrored: bool,
}

/// Visits the nodes of the chosen scene, parents first.
pub fn walk(file: &File<'_>, choice: Option<&SceneChoice>, warnings: &mut Warnings) -> Result<Placed> {
    let mut placed = Placed { meshes: Vec::new(), lights: Vec::new(), cameras: Vec::new() };
    let mut seen = vec![false; file.root.nodes.len()];
    let mut stack: Vec<_> = roots(file, choice)?.into_iter().rev().map(|node| (node, DAffine3::IDENTITY)).collect();
    if !file.root.animations.is_empty() {
        warnings.add(Warning::Animation, "animations are not played");
    }
    while let Some((index, parent)) = stack.pop() {
        let node = file.get(index, "node")?;
        let context = || label("node", index.value(), node.name.as_ref());
        if std::mem::replace(&mut seen[index.value()], true) {
            refuse!("{} is reached twice: nodes must form trees, without cycles and with one parent each", context());
        }
        if node.scale == Some([0.0; 3]) {
            // glTF's way to hide a node.
            warnings.add(Warning::HiddenNode, format!("{} has a scale of zero: it and all below it are left out", context()));
            continue;
        }
        let world = parent * local(node).with_context(context)?;
        place(file, index, node, world, &mut placed, warnings).with_context(context)?;
        stack.extend(node.children.iter().flatten().rev().map(|&child| (child, world)));
    }
    Ok(placed)
}

/// The chosen scene's roots: the default scene's, else the first one's; in a file without scenes, all nodes without a parent.
fn roots(file: &File<'_>, choice: Option<&SceneChoice>) -> Result<Vec<Index<Node>>> {
    let scenes = &file.root.scenes;
    let chosen = match choice {
        Some(SceneChoice::Index(index)) => scenes.get(*index),
        Some(SceneChoice::Name(name)) => scenes.iter().find(|scene| scene.name.as_ref() == Some(name)),
        None => match file.root.scene {
            Some(index) => Some(file.get(index, "scene")?),
            None => scenes.first(),
        },
    };
    if let Some(scene) = chosen {
        return Ok(scene.nodes.clone());
    }
    if let Some(choice) = choice {
        let wanted = match choice {
            SceneChoice::Index(index) => format!("{index}"),
            SceneChoice::Name(name) => format!("{name:?}"),
        };
        let list: Vec<_> = scenes.iter().enumerate().map(|(i, scene)| label("scene", i, scene.name.as_ref())).collect();
        refuse!("it has no scene {wanted}; there is {}", if list.is_empty() { "none".to_string() } else { list.join(", ") });
    }
    let nodes = &file.root.nodes;
    let mut has_parent = vec![false; nodes.len()];
    for child in nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(entry) = has_parent.get_mut(child.value()) {
            *entry = true;
        }
    }
    Ok((0..nodes.len()).filter(|&i| !has_parent[i]).map(|i| Index::new(i as u32)).collect())
}

/// A node's transform relative to its parent. In double precision, so that deep hierarchies do not drift.
fn local(node: &Node) -> Result<DAffine3> {
    let affine = if let Some(matrix) = node.matrix {
        let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
        if (matrix.row(3) - DMat4::IDENTITY.row(3)).abs().max_element() > 1e-4 {
            refuse!("the last row of its matrix is {}, it must be 0 0 0 1", matrix.row(3));
        }
        DAffine3::from_mat4(matrix)
    } else {
        let rotation = DQuat::from_array(node.rotation.unwrap_or_default().0.map(f64::from));
        if !(rotation.is_finite() && rotation.length() > 1e-3) {
            refuse!("its rotation {rotation} is not a unit quaternion");
        }
        let scale = DVec3::from(node.scale.unwrap_or([1.0; 3]).map(f64::from));
        let translation = DVec3::from(node.translation.unwrap_or([0.0; 3]).map(f64::from));
        DAffine3::from_scale_rotation_translation(scale, rotation.normalize(), translation)
    };
    if !affine.is_finite() {
        refuse!("its transform is not finite");
    }
    Ok(affine)
}

fn place(file: &File<'_>, index: Index<Node>, node: &Node, world: DAffine3, placed: &mut Placed, warnings: &mut Warnings) -> Result<()> {
    let light = node.extensions.as_ref().and_then(|extensions| extensions.khr_lights_punctual.as_ref());
    if node.mesh.is_none() && node.camera.is_none() && light.is_none() {
        return Ok(());
    }
    if is_singular(world.matrix3) || !world.translation.as_vec3().is_finite() {
        refuse!("its transform (with its parents') is singular: it has no inverse, so what hangs on it has no orientation");
    }
    if let Some(mesh) = node.mesh {
        if node.skin.is_some() {
            warnings.add(Warning::Skin, "skins are not supported: skinned meshes are shown as they were modelled");
        }
        let matrix = world.matrix3;
        placed.meshes.push(PlacedMesh {
            mesh,
            node: index.value(),
            transform: Affine3A::from_mat3_translation(matrix.as_mat3(), world.translation.as_vec3()),
            mirrored: matrix.determinant() < 0.0,
        });
    }
    if let Some(light) = light {
        placed.lights.push(lights::light(file, light.light, world, warnings)?);
    }
    if let Some(camera) = node.camera {
        placed.cameras.extend(lights::camera(file, camera, node, world, warnings)?);
    }
    Ok(())
}

/// Whether a matrix flattens space, or scales it beyond what single precision can hold.
fn is_singular(matrix: DMat3) -> bool {
    let lengths = DVec3::new(matrix.x_axis.length(), matrix.y_axis.length(), matrix.z_axis.length());
    let volume = matrix.determinant().abs() / lengths.element_product();
    !(lengths.min_element() > 1e-12 && lengths.max_element() < 1e12 && volume > 1e-9)
}
