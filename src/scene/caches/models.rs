//! Models: draws that move together. All draws that stand still and are drawn once are one model, so that sets of neighbours do not end where
//! materials do.

use super::Spacing;
use crate::scene::pack::octahedral_snorm16_inverse;
use crate::scene::{Draw, Scene};
use blake3::Hash;
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// A model as its first instance stands at second 0 of the animation, in the world.
#[derive(Debug, Default)]
pub(super) struct Model {
    pub instances: Vec<Vec<u32>>,
    pub triangles: Vec<Triangle>,
}

/// A triangle of a model.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    /// Indices of its vertices.
    pub corners: [u32; 3],
    /// Its draw, among those of the model.
    pub draw: u32,
    pub double_sided: bool,
    pub positions: [Vec3; 3],
    /// Normals of its corners, not normalized.
    pub normals: [Vec3; 3],
}

/// What draws share that move together.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Tie {
    Still,
    /// The moving node that they hang on.
    Node(usize),
    /// The bits of their transform: draws that stand still, whose vertices are drawn elsewhere too.
    Place([u32; 12]),
    /// Nothing: the draw bends.
    Alone(usize),
}

/// Triangles of a draw.
type Range = (u32, u32, u32);

fn range(draw: &Draw) -> Range {
    (draw.first_index, draw.index_count, draw.vertex_offset)
}

/// Models of a scene, without draws that have no triangles.
pub(super) fn models(scene: &Scene) -> Vec<Model> {
    let hung = scene.animation.iter().flat_map(|animation| &animation.draws);
    let nodes: BTreeMap<usize, usize> = hung.map(|hung| (hung.index, hung.node)).collect();
    // Vertices that stand in several places have a list in each.
    let bits = |draw: &Draw| draw.transform.to_cols_array().map(f32::to_bits);
    let mut places: BTreeMap<u32, BTreeSet<[u32; 12]>> = BTreeMap::new();
    for draw in &scene.draws {
        places.entry(draw.vertex_offset).or_default().insert(bits(draw));
    }
    let tie = |number: usize, draw: &Draw| match nodes.get(&number) {
        Some(node) => Tie::Node(*node),
        None if scene.bending.as_ref().is_some_and(|bending| bending.mesh_of(draw).is_some()) => Tie::Alone(number),
        None if places[&draw.vertex_offset].len() == 1 => Tie::Still,
        None => Tie::Place(bits(draw)),
    };
    let mut tied: BTreeMap<Tie, Vec<u32>> = BTreeMap::new();
    for (number, draw) in scene.draws.iter().enumerate().filter(|(_, draw)| draw.index_count > 0) {
        tied.entry(tie(number, draw)).or_default().push(number as u32);
    }
    // Groups with the same triangles, of as many sides, are instances of one model.
    let mut models: BTreeMap<Vec<(Range, bool)>, Vec<Vec<u32>>> = BTreeMap::new();
    let sided = |number: &u32| {
        let draw = &scene.draws[*number as usize];
        (range(draw), scene.materials[draw.material as usize].double_sided)
    };
    for mut draws in tied.into_values() {
        draws.sort_by_key(|number| (range(&scene.draws[*number as usize]), *number));
        models.entry(draws.iter().map(sided).collect()).or_default().push(draws);
    }
    models.into_values().map(|instances| Model { triangles: triangles(scene, &instances[0]), instances }).collect()
}

fn triangles(scene: &Scene, draws: &[u32]) -> Vec<Triangle> {
    let of_draw = |(at, number): (u32, &u32)| {
        let draw = &scene.draws[*number as usize];
        let double_sided = scene.materials[draw.material as usize].double_sided;
        // The cofactor matrix transforms normals under any scale; the sign is the transform's own.
        let [x, y, z] = [draw.transform.matrix3.x_axis, draw.transform.matrix3.y_axis, draw.transform.matrix3.z_axis];
        let cofactors = [y.cross(z), z.cross(x), x.cross(y)];
        let sign = if x.dot(cofactors[0]) < 0.0 { -1.0 } else { 1.0 };
        let indices = &scene.indices[draw.first_index as usize..(draw.first_index + draw.index_count) as usize];
        indices.as_chunks::<3>().0.iter().map(move |corners| {
            let corners = corners.map(|index| index + draw.vertex_offset);
            let vertices = corners.map(|corner| &scene.vertices[corner as usize]);
            Triangle {
                corners,
                draw: at,
                double_sided,
                positions: vertices.map(|vertex| draw.transform.transform_point3(vertex.position.into())),
                normals: vertices.map(|vertex| {
                    let normal = octahedral_snorm16_inverse(vertex.normal);
                    (sign * (cofactors[0] * normal.x + cofactors[1] * normal.y + cofactors[2] * normal.z)).into()
                }),
            }
        })
    };
    (0..).zip(draws).flat_map(of_draw).collect()
}

impl Model {
    /// Surface, m^2: both sides where there are two.
    pub fn area(&self) -> f64 {
        self.triangles.iter().map(|triangle| f64::from(triangle.area()) * if triangle.double_sided { 2.0 } else { 1.0 }).sum()
    }

    /// Vertices and where they are, in order.
    pub fn positions(&self) -> Vec<(u32, Vec3)> {
        let corners = self.triangles.iter().flat_map(|triangle| triangle.corners.into_iter().zip(triangle.positions));
        let mut positions: Vec<(u32, Vec3)> = corners.collect();
        positions.sort_by_key(|(vertex, _)| *vertex);
        positions.dedup_by_key(|(vertex, _)| *vertex);
        positions
    }
}

impl Triangle {
    pub fn area(&self) -> f32 {
        let [a, b, c] = self.positions;
        0.5 * (b - a).cross(c - a).length()
    }
}

/// Hash of all that caches hang on.
pub(super) fn key(scene: &Scene, models: &[Model], spacing: Spacing, version: u32) -> Hash {
    let mut hasher = blake3::Hasher::new();
    hasher.update(bytemuck::cast_slice(&[version, spacing.distance.to_bits(), spacing.angle.to_bits(), spacing.open.into()]));
    hasher.update(bytemuck::cast_slice(&scene.vertices)).update(bytemuck::cast_slice(&scene.indices));
    for model in models {
        hasher.update(&[0xff]);
        for number in &model.instances[0] {
            let draw = &scene.draws[*number as usize];
            let (first, count, offset) = range(draw);
            let two = u32::from(scene.materials[draw.material as usize].double_sided);
            hasher.update(bytemuck::cast_slice(&[first, count, offset, two]));
            hasher.update(bytemuck::cast_slice(&draw.transform.to_cols_array()));
        }
    }
    hasher.finalize()
}
