//! The node hierarchy: world transforms of meshes, lights and cameras.

use super::animations::{Moved, Played};
use super::{File, SceneChoice, Warning, Warnings, label, lights, refuse};
use crate::scene::animation::{Animation, Hung, Local, MovingNode, Parent, single};
use crate::scene::{Camera, Light};
use anyhow::{Context, Result};
use glam::{Affine3A, DAffine3, DMat3, DMat4, DQuat, DVec3};
use gltf_json::extensions::scene::khr_lights_punctual::Light as PunctualLight;
use gltf_json::{Index, Mesh, Node, Skin};
use std::collections::HashMap;

/// Meshes, lights and cameras placed in the world by nodes.
#[derive(Default)]
pub struct Placed {
    pub meshes: Vec<PlacedMesh>,
    pub lights: Vec<Light>,
    pub cameras: Vec<Camera>,
    /// The animation, still without the meshes' draws.
    pub animation: Option<Animation>,
    /// Each of the file's nodes: its world transform, or its number among the moving nodes; `None` if it is not in the scene.
    pub nodes: Vec<Option<Parent>>,
    /// Tracks of the weights of nodes' morph targets, by the node's index: one a target.
    pub weights: HashMap<usize, Vec<usize>>,
}

/// A mesh at a node.
pub struct PlacedMesh {
    pub mesh: Index<Mesh>,
    /// Index of the node, for messages.
    pub node: usize,
    pub transform: Affine3A,
    /// Whether the transform flips handedness, and with it the order of a triangle's corners.
    pub mirrored: bool,
    /// The moving node that the mesh is attached to.
    pub moves: Option<usize>,
    /// The skin that bends it; its node's transform then does not matter.
    pub skin: Option<Index<Skin>>,
}

/// A node to visit: its index, its parent, and whether nothing on it is shown.
type Step = (Index<Node>, Parent, bool);

/// Visits the nodes of the chosen scene, parents first. Animated nodes are placed at time 0.
pub fn walk(file: &File<'_>, choice: Option<&SceneChoice>, played: Option<Played>, warnings: &mut Warnings) -> Result<Placed> {
    let mut placed = Placed { nodes: vec![None; file.root.nodes.len()], ..Placed::default() };
    let (label_of_animation, moved) = played.as_ref().map(|played| (played.label.clone(), played.nodes.clone())).unwrap_or_default();
    let mut animation = played.map(|played| {
        placed.weights = played.weights;
        Animation {
            name: played.name,
            duration: played.duration,
            tracks: played.tracks,
            nodes: Vec::new(),
            draws: Vec::new(),
            lights: Vec::new(),
            cameras: Vec::new(),
        }
    });
    let mut seen = vec![false; file.root.nodes.len()];
    let mut stack: Vec<Step> =
        roots(file, choice)?.into_iter().rev().map(|node| (node, Parent::Still(DAffine3::IDENTITY), false)).collect();
    // World transform of each moving node at time 0.
    let mut worlds: Vec<DAffine3> = Vec::new();
    while let Some((index, parent, mut hidden)) = stack.pop() {
        let node = file.get(index, "node")?;
        let context = || label("node", index.value(), node.name.as_ref());
        if std::mem::replace(&mut seen[index.value()], true) {
            refuse!("{} is reached twice: nodes must form trees, without cycles and with one parent each", context());
        }
        let moved = moved.get(&index.value());
        if node.scale == Some([0.0; 3]) && moved.is_none_or(|moved| moved.scale.is_none()) {
            // A scale of zero is glTF's way to hide a node.
            warnings.add(Warning::HiddenNode, format!("{} has a scale of zero: it and all below it are left out", context()));
            // It may still be a joint.
            if file.root.skins.is_empty() {
                continue;
            }
            hidden = true;
        }
        let here = match (&mut animation, parent, moved) {
            (None, Parent::Still(parent), _) | (_, Parent::Still(parent), None) => {
                let world = parent * local(node).with_context(context)?;
                if !hidden {
                    place(file, index, node, world, &mut placed, warnings).with_context(context)?;
                }
                Parent::Still(world)
            }
            (Some(animation), parent, moved) => {
                let local = match moved {
                    Some(moved) => moving(node, moved).with_context(context)?,
                    None => Local::Still(local(node).with_context(context)?),
                };
                worlds.push(animation.world(&MovingNode { parent, local }, &worlds, 0.0));
                animation.nodes.push(MovingNode { parent, local });
                let number = animation.nodes.len() - 1;
                if !hidden {
                    hang(file, index, node, (number, worlds[number]), animation, &mut placed, warnings).with_context(context)?;
                }
                Parent::Moving(number)
            }
            (None, Parent::Moving(_), _) => unreachable!("without an animation nothing moves"),
        };
        placed.nodes[index.value()] = Some(here);
        stack.extend(node.children.iter().flatten().rev().map(|&child| (child, here, hidden)));
    }
    placed.animation = animation;
    orient(&mut placed, &label_of_animation, warnings);
    Ok(placed)
}

/// Roots of the chosen scene, the default scene or the first scene; in a file without scenes, all nodes without a parent.
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

/// A node's transform relative to its parent, in double precision so that deep hierarchies do not drift.
fn local(node: &Node) -> Result<DAffine3> {
    let affine = if let Some(matrix) = node.matrix {
        let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
        if (matrix.row(3) - DMat4::IDENTITY.row(3)).abs().max_element() > 1e-4 {
            refuse!("the last row of its matrix is {}, it must be 0 0 0 1", matrix.row(3));
        }
        DAffine3::from_mat4(matrix)
    } else {
        let (translation, rotation, scale) = properties(node)?;
        DAffine3::from_scale_rotation_translation(scale, rotation, translation)
    };
    if !affine.is_finite() {
        refuse!("its transform is not finite");
    }
    Ok(affine)
}

/// A node's translation, rotation and scale.
fn properties(node: &Node) -> Result<(DVec3, DQuat, DVec3)> {
    let rotation = DQuat::from_array(node.rotation.unwrap_or_default().0.map(f64::from));
    if !(rotation.is_finite() && rotation.length() > 1e-3) {
        refuse!("its rotation {rotation} is not a unit quaternion");
    }
    let scale = DVec3::from(node.scale.unwrap_or([1.0; 3]).map(f64::from));
    let translation = DVec3::from(node.translation.unwrap_or([0.0; 3]).map(f64::from));
    if !(scale.is_finite() && translation.is_finite()) {
        refuse!("its transform is not finite");
    }
    Ok((translation, rotation.normalize(), scale))
}

/// The transform of a node with tracks.
fn moving(node: &Node, moved: &Moved) -> Result<Local> {
    let (translation, rotation, scale) = properties(node)?;
    let Moved { translation: translation_track, rotation: rotation_track, scale: scale_track } = *moved;
    Ok(Local::Moving { translation, rotation, scale, translation_track, rotation_track, scale_track })
}

/// Places the mesh, light and camera of a node that does not move.
fn place(file: &File<'_>, index: Index<Node>, node: &Node, world: DAffine3, placed: &mut Placed, warnings: &mut Warnings) -> Result<()> {
    let carries = (node.mesh.is_some() && node.skin.is_none()) || node.camera.is_some() || light_of(node).is_some();
    if carries && (is_singular(world.matrix3) || !world.translation.as_vec3().is_finite()) {
        refuse!("its transform (with its parents') is singular: it has no inverse, so what hangs on it has no orientation");
    }
    carry(file, index, node, world, None, placed, warnings)
}

/// Places the mesh, light and camera of a moving node, given its index and its transform at time 0, and attaches them to the
/// animation. A moving node may shrink to nothing at times.
fn hang(
    file: &File<'_>,
    index: Index<Node>,
    node: &Node,
    (number, world): (usize, DAffine3),
    animation: &mut Animation,
    placed: &mut Placed,
    warnings: &mut Warnings,
) -> Result<()> {
    let (lights, cameras) = (placed.lights.len(), placed.cameras.len());
    carry(file, index, node, world, Some(number), placed, warnings)?;
    let hung = |index: usize| Hung { index, node: number };
    animation.lights.extend((lights..placed.lights.len()).map(hung));
    animation.cameras.extend((cameras..placed.cameras.len()).map(hung));
    Ok(())
}

fn light_of(node: &Node) -> Option<Index<PunctualLight>> {
    node.extensions.as_ref()?.khr_lights_punctual.as_ref().map(|light| light.light)
}

fn carry(
    file: &File<'_>,
    index: Index<Node>,
    node: &Node,
    world: DAffine3,
    moves: Option<usize>,
    placed: &mut Placed,
    warnings: &mut Warnings,
) -> Result<()> {
    if let Some(mesh) = node.mesh {
        let (node_index, mirrored) = (index.value(), world.matrix3.determinant() < 0.0);
        placed.meshes.push(match node.skin {
            // Its joints alone place it; whether they mirror it is known once all are placed.
            Some(_) => PlacedMesh { mesh, node: node_index, transform: Affine3A::IDENTITY, mirrored: false, moves: None, skin: node.skin },
            None => PlacedMesh { mesh, node: node_index, transform: single(world), mirrored, moves, skin: None },
        });
    }
    if let Some(light) = light_of(node) {
        placed.lights.push(lights::light(file, light, world, warnings)?);
    }
    if let Some(camera) = node.camera {
        placed.cameras.extend(lights::camera(file, camera, node, world, warnings)?);
    }
    Ok(())
}

/// Determines which moving meshes are mirrored. Time 0 alone is not enough: a node may have no size then, and so no
/// orientation.
fn orient(placed: &mut Placed, label_of_animation: &str, warnings: &mut Warnings) {
    let Some(animation) = &placed.animation else { return };
    // Whether each moving node is unmirrored, and whether it is mirrored, at any sampled time.
    let mut seen = vec![[false; 2]; animation.nodes.len()];
    let mut first = vec![None; animation.nodes.len()];
    for seconds in animation.samples() {
        for (node, world) in animation.worlds(seconds).iter().enumerate() {
            let determinant = world.matrix3.determinant();
            if determinant != 0.0 {
                seen[node][usize::from(determinant < 0.0)] = true;
                first[node].get_or_insert(determinant < 0.0);
            }
        }
    }
    for mesh in &mut placed.meshes {
        let Some(node) = mesh.moves else { continue };
        mesh.mirrored = first[node].unwrap_or(false);
        if seen[node] == [true, true] {
            let sentence = format!("{label_of_animation} mirrors node {} at times: it shows its inside then", mesh.node);
            warnings.add(Warning::Mirrored, sentence);
        }
    }
}

/// Whether a matrix flattens space, or scales beyond the range of single precision.
fn is_singular(matrix: DMat3) -> bool {
    let lengths = DVec3::new(matrix.x_axis.length(), matrix.y_axis.length(), matrix.z_axis.length());
    let volume = matrix.determinant().abs() / lengths.element_product();
    !(lengths.min_element() > 1e-12 && lengths.max_element() < 1e12 && volume > 1e-9)
}
