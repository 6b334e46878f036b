//! Primitives that bend: influences of joints and displacements of morph targets, and the copies of vertices that they bend.

use super::accessors::Attribute;
use super::animations::morph_targets;
use super::geometry::{MAX_DISTANCE, MAX_VERTICES, is_near, read};
use super::nodes::PlacedMesh;
use super::skins::Skins;
use super::{File, Warning, Warnings, refuse};
use crate::scene::bend::{Bending, BentMesh, Delta, Influences, Morph, Skinning, Weight};
use crate::scene::{Scene, Vertex};
use anyhow::{Context, Result};
use glam::Vec3;
use gltf_json::Mesh;
use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::validation::Checked;
use std::collections::HashMap;

/// Limit of displacements, over all targets: a small file in which many targets share accessors would fill the memory.
const MAX_DELTAS: usize = 1 << 24;
/// Sets of four joints a vertex.
const MAX_SETS: u32 = 2;

/// Accessors by which a range of vertices bends. Without any it does not bend.
#[derive(Clone, Default, PartialEq, Eq, Hash)]
pub struct BendKey {
    /// JOINTS_n and WEIGHTS_n.
    sets: Vec<[usize; 2]>,
    /// POSITION and NORMAL of each target.
    targets: Vec<[Option<usize>; 2]>,
    /// Flat normals are made for each target.
    flat: bool,
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
    /// First influence, and sets a vertex.
    influences: Option<(u32, u32)>,
    /// The greatest number of a joint with a weight, and a vertex that it influences.
    most: (u16, usize),
    /// First displacement, the number of targets, and whether any displaces normals.
    deltas: Option<(u32, usize, bool)>,
}

/// Meshes that bend, under construction.
pub struct Bends<'a> {
    file: &'a File<'a>,
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
        let (influences, most) = self.influences(key, sources, warnings)?;
        let deltas = self.deltas(key, &vertices, sources)?;
        self.made.rest.extend(vertices);
        self.templates.push(Template { rest: rest as u32, count: count as u32, influences, most, deltas });
        Ok(self.templates.len() - 1)
    }

    fn influences(
        &mut self,
        key: &BendKey,
        (count, sources): (usize, &[u32]),
        warnings: &mut Warnings,
    ) -> Result<(Option<(u32, u32)>, (u16, usize))> {
        let mut most = (0, 0);
        if key.sets.is_empty() {
            return Ok((None, most));
        }
        let mut sets = Vec::new();
        for ([joints, weights], set) in key.sets.iter().zip(0..) {
            let joints: Vec<[f32; 4]> = read(self.file, Some(*joints), Attribute::Joints(set), Some(count))?;
            let weights: Vec<[f32; 4]> = read(self.file, Some(*weights), Attribute::Weights(set), Some(count))?;
            if let Some(bad) = weights.iter().position(|weights| weights.iter().any(|weight| *weight < 0.0)) {
                refuse!("WEIGHTS_{set} of vertex {bad} are {:?}, weights cannot be below 0", weights[bad]);
            }
            sets.push((joints, weights));
        }
        // A second set without weights would cost time for nothing.
        if sets.len() > 1 && sets[1].1.as_flattened().iter().all(|weight| *weight == 0.0) {
            sets.truncate(1);
        }
        let first = self.made.influences.len() as u32;
        let mut weightless = 0;
        for vertex in sources.iter().map(|source| *source as usize) {
            let joints: Vec<u16> = sets.iter().flat_map(|(joints, _)| joints[vertex]).map(|joint| joint as u16).collect();
            let weights: Vec<f32> = sets.iter().flat_map(|(_, weights)| weights[vertex]).collect();
            let shares = shares(&weights).unwrap_or_else(|| {
                weightless += 1;
                std::iter::once(65535).chain(std::iter::repeat(0)).take(weights.len()).collect()
            });
            // A joint without a weight may be any number; the device reads its matrix.
            let joints: Vec<u16> = joints.iter().zip(&shares).map(|(joint, share)| if *share > 0 { *joint } else { 0 }).collect();
            most = joints.iter().fold(most, |most, joint| if *joint > most.0 { (*joint, vertex) } else { most });
            let fours = joints.as_chunks().0.iter().zip(shares.as_chunks().0);
            self.made.influences.extend(fours.map(|(joints, weights)| Influences { joints: *joints, weights: *weights }));
        }
        if weightless > 0 {
            warnings.add(Warning::Weightless, "some vertices have a skin and no weights: they follow the first of their joints");
        }
        Ok((Some((first, sets.len() as u32)), most))
    }

    fn deltas(&mut self, key: &BendKey, vertices: &[Vertex], (count, sources): (usize, &[u32])) -> Result<Option<(u32, usize, bool)>> {
        if key.targets.is_empty() {
            return Ok(None);
        }
        let first = self.made.deltas.len();
        if key.targets.len().saturating_mul(vertices.len()).saturating_add(first) > MAX_DELTAS {
            refuse!("with it, the morph targets displace more than {MAX_DELTAS} vertices");
        }
        for (target, [positions, normals]) in key.targets.iter().enumerate() {
            let context = || format!("target {target}");
            let positions: Vec<[f32; 3]> = read(self.file, *positions, Attribute::Position, Some(count)).with_context(context)?;
            let normals: Vec<[f32; 3]> = read(self.file, *normals, Attribute::Normal, Some(count)).with_context(context)?;
            let at = |all: &[[f32; 3]], source: u32| all.get(source as usize).copied().unwrap_or_default();
            let own = sources.iter().map(|source| Delta { position: at(&positions, *source), normal: at(&normals, *source) });
            self.made.deltas.extend(own);
            if key.flat {
                flatten(vertices, &mut self.made.deltas[first + target * vertices.len()..]);
            }
        }
        let normals = self.made.deltas[first..].iter().any(|delta| delta.normal != [0.0; 3]);
        Ok(Some((first as u32, key.targets.len(), normals)))
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
            (Some(index), Some((influences, fours))) => {
                let joints = self.skins.get(index);
                if u32::from(template.most.0) >= joints.count {
                    let (joint, vertex) = template.most;
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

/// Weights as unsigned normalized 16-bit numbers that sum to 65535; `None` if all weights are 0.
fn shares(weights: &[f32]) -> Option<Vec<u16>> {
    let sum: f64 = weights.iter().map(|weight| f64::from(*weight)).sum();
    if sum <= 0.0 {
        return None;
    }
    let exact: Vec<f64> = weights.iter().map(|weight| f64::from(*weight) / sum * 65535.0).collect();
    let mut shares: Vec<u16> = exact.iter().map(|exact| *exact as u16).collect();
    // What rounding down left over goes to the largest remainders.
    let mut order: Vec<usize> = (0..weights.len()).collect();
    order.sort_by(|a, b| exact[*b].fract().total_cmp(&exact[*a].fract()));
    let missing = 65535 - shares.iter().map(|share| usize::from(*share)).sum::<usize>();
    order.iter().cycle().take(missing).for_each(|i| shares[*i] += 1);
    Some(shares)
}

/// Gives each triangle's corners the displacement of its flat normal. A triangle that a target flattens to nothing keeps its normal.
fn flatten(vertices: &[Vertex], deltas: &mut [Delta]) {
    for (corners, deltas) in vertices.as_chunks::<3>().0.iter().zip(deltas.as_chunks_mut::<3>().0) {
        let rest = corners.map(|vertex| Vec3::from(vertex.position).as_dvec3());
        let bent: [_; 3] = std::array::from_fn(|k| rest[k] + Vec3::from(deltas[k].position).as_dvec3());
        let [before, after] = [rest, bent].map(|[a, b, c]| (b - a).cross(c - a).try_normalize());
        let normal = before.zip(after).map_or(Vec3::ZERO, |(before, after)| (after - before).as_vec3());
        deltas.iter_mut().for_each(|delta| delta.normal = normal.into());
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_weights_that_sum_to_one_exactly() {
        for weights in [vec![0.1, 0.2, 0.3, 0.4], vec![1.0, 1.0, 1.0, 0.0], vec![1e-9; 8], vec![3e38; 8], vec![0.5, 0.25, 0.125, 1e-7]] {
            let sum: f64 = weights.iter().map(|weight| f64::from(*weight)).sum();
            let shares = shares(&weights).unwrap();
            assert_eq!(shares.iter().map(|share| u32::from(*share)).sum::<u32>(), 65535, "{weights:?}");
            for (share, weight) in shares.iter().zip(&weights) {
                assert!((f64::from(*share) / 65535.0 - f64::from(*weight) / sum).abs() <= 1.0 / 65535.0, "{weights:?}: {shares:?}");
            }
        }
        assert_eq!(shares(&[0.0; 4]), None);
    }
}
