//! Primitives that bend: influences of joints and displacements of morph targets, and the copies of vertices that they bend.

use super::animations::morph_targets;
use super::geometry::{MAX_DISTANCE, MAX_VERTICES, is_near};
use super::nodes::PlacedMesh;
use super::skins::Skins;
use super::{File, Warning, Warnings, refuse};
use crate::scene::bend::{Bending, BentMesh, Morph, Skinning, Weight};
use crate::scene::{Scene, Vertex};
use anyhow::Result;
use gltf_json::Mesh;
use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::validation::Checked;
use std::collections::HashMap;

/// Sets of four joints a vertex.
const MAX_SETS: u32 = 2;

/// Accessors by which a range of vertices bends. Without any it does not bend.
#[derive(Clone, Default, PartialEq, Eq, Hash)]
pub struct BendKey {
    /// JOINTS_n and WEIGHTS_n.
    pub(super) sets: Vec<[usize; 2]>,
    /// POSITION and NORMAL of each target.
    pub(super) targets: Vec<[Option<usize>; 2]>,
    /// Flat normals are made for each target.
    pub(super) flat: bool,
}

impl BendKey {
    pub fn bends(&self) -> bool {
        !(self.sets.is_empty() && self.targets.is_empty())
    }
}

/// A range of vertices as modelled.
struct Template {
    rest: u32,
    count: u32,
    influences: Option<Influenced>,
    /// First displacement, the number of targets, and whether any displaces normals.
    deltas: Option<(u32, usize, bool)>,
}

/// Influences of joints on a range of vertices.
#[derive(Clone, Copy)]
pub(super) struct Influenced {
    /// First of them in [`Bending::influences`], and sets of four a vertex.
    pub first: u32,
    pub fours: u32,
    /// The greatest number of a joint with a weight, and a vertex that it influences.
    pub most: (u16, usize),
}

/// Meshes that bend, under construction.
pub struct Bends<'a> {
    pub(super) file: &'a File<'a>,
    skins: Skins,
    /// Tracks of the weights of nodes' morph targets, by the node's index: one a target.
    tracks: HashMap<usize, Vec<usize>>,
    templates: Vec<Template>,
    /// First vertices of the copies of a template for a node.
    copies: HashMap<(usize, usize), u32>,
    pub made: Bending,
}

impl<'a> Bends<'a> {
    pub fn new(file: &'a File<'a>, mut skins: Skins, tracks: HashMap<usize, Vec<usize>>) -> Self {
        let made = Bending { joints: std::mem::take(&mut skins.joints), ..Bending::default() };
        Self { file, skins, tracks, templates: Vec::new(), copies: HashMap::new(), made }
    }

    /// Weights of a mesh's morph targets at a node. There are none if no target is ever used.
    fn weights(&self, mesh: &Mesh, node: usize) -> Result<Vec<Weight>> {
        let targets = morph_targets(mesh);
        if let Some(tracks) = self.tracks.get(&node) {
            return Ok(tracks.iter().map(|track| Weight::Moving(*track)).collect());
        }
        let own = self.file.root.nodes[node].weights.as_ref().map(|weights| (weights, "its node's"));
        let Some((weights, whose)) = own.or(mesh.weights.as_ref().map(|weights| (weights, "its"))) else { return Ok(Vec::new()) };
        if weights.len() != targets {
            refuse!("{whose} weights are {}, it has {targets} morph targets", weights.len());
        }
        if let Some(bad) = weights.iter().find(|weight| !weight.is_finite()) {
            refuse!("one of {whose} weights is {bad}");
        }
        let used = weights.iter().any(|weight| *weight != 0.0);
        Ok(if used { weights.iter().map(|weight| Weight::Still(*weight)).collect() } else { Vec::new() })
    }

    /// Inputs by which a primitive bends at a node.
    pub fn key(&self, mesh: &Mesh, primitive: &Primitive, placed: &PlacedMesh, warnings: &mut Warnings) -> Result<BendKey> {
        let attribute = |semantic: Semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|accessor| accessor.value());
        let mut key = BendKey::default();
        if placed.skin.is_some() {
            for set in 0.. {
                let [joints, weights] = [attribute(Semantic::Joints(set)), attribute(Semantic::Weights(set))];
                match (joints, weights) {
                    (Some(_), Some(_)) if set >= MAX_SETS => {
                        let sentence = "some vertices have more than eight joints: those of JOINTS_2 and after do not bend them";
                        warnings.add(Warning::Joints, sentence);
                        break;
                    }
                    (Some(joints), Some(weights)) => key.sets.push([joints, weights]),
                    (None, None) if set > 0 => break,
                    (None, _) => refuse!("it has no JOINTS_{set}, which its node's skin needs"),
                    (_, None) => refuse!("it has no WEIGHTS_{set}, which its node's skin needs"),
                }
            }
        }
        let (own, all) = (primitive.targets.as_ref().map_or(0, Vec::len), morph_targets(mesh));
        if own != all {
            refuse!("it has {own} morph targets, the mesh's first primitive {all}");
        }
        if !self.weights(mesh, placed.node)?.is_empty() {
            let targets = primitive.targets.iter().flatten();
            key.targets = targets.map(|target| [target.positions, target.normals].map(|a| a.map(|a| a.value()))).collect();
            key.flat = attribute(Semantic::Normals).is_none();
        }
        Ok(key)
    }

    /// Adds vertices as modelled. `sources` are the number of elements of their accessors, and the element of each vertex. The result is
    /// the template's number.
    pub fn add(&mut self, key: &BendKey, vertices: Vec<Vertex>, sources: (usize, &[u32]), warnings: &mut Warnings) -> Result<usize> {
        let (rest, count) = (self.made.rest.len(), vertices.len());
        if rest + count > MAX_VERTICES {
            refuse!("with it, the meshes that bend have more than {MAX_VERTICES} vertices");
        }
        let influences = self.influences(key, sources, warnings)?;
        let deltas = self.deltas(key, &vertices, sources)?;
        self.made.rest.extend(vertices);
        self.templates.push(Template { rest: rest as u32, count: count as u32, influences, deltas });
        Ok(self.templates.len() - 1)
    }

    /// The first vertex of a template's copy for a node.
    pub fn copy(&mut self, number: usize, mesh: &Mesh, placed: &PlacedMesh, scene: &mut Scene) -> Result<u32> {
        if let Some(known) = self.copies.get(&(number, placed.node)) {
            return Ok(*known);
        }
        let template = &self.templates[number];
        let (first, rest, count) = (scene.vertices.len(), template.rest as usize, template.count as usize);
        if first + count > MAX_VERTICES {
            refuse!("with it, the scene has more than {MAX_VERTICES} vertices");
        }
        let skin = match (placed.skin, template.influences) {
            (Some(index), Some(Influenced { first: influences, fours, most: (joint, vertex) })) => {
                let joints = self.skins.get(index);
                if u32::from(joint) >= joints.count {
                    refuse!("its vertex {vertex} follows joint {joint}, skin {index} of node {} has {}", placed.node, joints.count);
                }
                Some(Skinning { joints: joints.first, influences, fours })
            }
            _ => None,
        };
        let morph = match template.deltas {
            Some((deltas, _, normals)) => Some(Morph { deltas, normals, weights: self.weights(mesh, placed.node)? }),
            None => None,
        };
        self.made.meshes.push(BentMesh { first: first as u32, count: template.count, rest: template.rest, skin, morph });
        scene.vertices.extend_from_slice(&self.made.rest[rest..rest + count]);
        self.copies.insert((number, placed.node), first as u32);
        Ok(first as u32)
    }
}

/// Puts each vertex's number in place of its colour, and returns the colours. What makes vertices of vertices copies colours alone.
pub fn number(vertices: &mut [Vertex]) -> Vec<u32> {
    vertices.iter_mut().zip(0..).map(|(vertex, number)| std::mem::replace(&mut vertex.color, number)).collect()
}

/// Gives vertices their colours back, and returns the numbers.
pub fn restore(vertices: &mut [Vertex], colors: &[u32]) -> Vec<u32> {
    let back = |vertex: &mut Vertex| {
        let number = vertex.color;
        vertex.color = colors[number as usize];
        number
    };
    vertices.iter_mut().map(back).collect()
}

/// Puts the meshes that bend into the scene, at time 0. Those whose shape does not change become meshes like any other.
pub fn finish(scene: &mut Scene, made: Bending) -> Result<()> {
    if made.meshes.is_empty() {
        return Ok(());
    }
    scene.bending = Some(made);
    scene.pose(0.0);
    for draw in &scene.draws {
        let far = scene
            .reach(draw)
            .zip(scene.bending.as_ref())
            .is_some_and(|(reach, bending)| !is_near(reach.bounds(&bending.pose, &draw.transform)));
        if far {
            let material = &scene.materials[draw.material as usize].name;
            refuse!("a bent mesh of material {material:?} reaches farther than {MAX_DISTANCE:e} m from the origin");
        }
    }
    scene.bake();
    Ok(())
}
