//! A bounding volume hierarchy over all triangles of a scene, laid out for the traversal in `glsl/bvh/traverse.glsl`.
//!
//! The crate obvhs builds the tree (PLOC with reinsertion); this module turns it into records of 16-byte texels. The records lie in images:
//! a software driver loads a texel at once but a storage buffer word by word, and limits storage buffers to 128 MiB.

use super::traced::{first_texels, texel_map};
use crate::scene::{Map, Material, Scene, Vertex, pack};
use glam::{Affine3A, Mat3A, Vec2, Vec3, Vec3A};
use obvhs::aabb::Aabb as BuildAabb;
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::ploc::{PlocSearchDistance, SortPrecision};
use obvhs::{Boundable, BvhBuildParams};
use rayon::prelude::*;
use std::time::Duration;

/// Set in a link to a leaf: the next bits hold the number of its triangles less one, the rest the first triangle.
const LEAF: u32 = 1 << 31;
const COUNT_SHIFT: u32 = 28;
/// Triangles of a leaf, at most; their number must fit between [`LEAF`] and [`COUNT_SHIFT`].
const MOST_IN_LEAF: u32 = 2;
/// Triangles that links can address.
pub const MOST_TRIANGLES: u64 = 1 << COUNT_SHIFT;
/// Entries of the traversal's stack, one a level; deeper trees are refused.
pub const STACK: usize = 64;

/// Flags of a triangle for the traversal.
pub mod flags {
    /// Its texture has holes (alpha mask).
    pub const MASKED: u32 = 1;
    /// Its back is invisible to the camera, and ends light.
    pub const SINGLE_SIDED: u32 = 2;
    /// The bits from here on hold the number of a masked triangle's [`super::Mask`].
    pub const MASK_SHIFT: u32 = 2;
}

/// Alpha test of a masked triangle: texture coordinates of its corners (two numbers each), the texture's words
/// ([`super::traced::texel_map`]), the alpha factor, the corners' own alpha (a byte each), and the cutoff.
pub type Mask = [u32; 12];

/// Two children of a node: boxes on a grid of 2^16 cells a side, 6 words, and links.
///
/// Word k of the first three holds the first child's lower (low half) and upper (high half) plane of axis k, then its link; the
/// other four words are the second child's. A link is a node's number, or [`LEAF`] with count - 1 and first triangle.
pub type Node = [u32; 8];

/// Three world-space corners, each followed by a word: the material, padding, and [`flags`].
pub type Triangle = [u32; 12];

/// Shading attributes of the three corners, four words each: world-space normal ([`pack::octahedral_snorm16`]), texture coordinates, and
/// world-space tangent ([`pack::tangent`]).
pub type Corners = [u32; 12];

/// A bounding volume hierarchy in the layout of the shaders.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Bvh {
    /// Lower corner of the grid and the size of its cells, metres.
    pub origin: Vec3,
    pub cell: Vec3,
    /// Nodes; the first is the root.
    pub nodes: Vec<Node>,
    /// Triangles in the order of the leaves; each is in one leaf alone. The emitting ones follow once more from `emitting.first` on.
    pub triangles: Vec<Triangle>,
    pub emitting: Emitting,
    /// Shading attributes of `triangles`, in the same order.
    pub corners: Vec<Corners>,
    /// Vertex colours of `triangles` ([`pack::unorm8x4`]), each with a word of padding. Empty if all are white.
    pub colors: Vec<[u32; 4]>,
    /// Alpha tests of the masked triangles.
    pub masks: Vec<Mask>,
    /// Nodes on the longest path from the root.
    pub depth: usize,
}

/// A second tree of the emitting triangles alone, for rays that only query emitters. If so many triangles emit that a second tree would
/// cost more than it saves, this is the whole tree.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Emitting {
    /// Index of its root.
    pub root: u32,
    /// Index of its first triangle; all later triangles are its own.
    pub first: usize,
}

/// Emitting triangles get a tree of their own if they are at most one in this many.
const FEW: usize = 4;

struct Bounded([Vec3A; 3]);

impl Boundable for Bounded {
    fn aabb(&self) -> BuildAabb {
        BuildAabb::from_points(&self.0)
    }
}

impl Bvh {
    /// Builds the tree of all triangles of a scene, in world space.
    pub fn build(scene: &Scene) -> Self {
        let mut records: Vec<Triangle> = Vec::with_capacity(scene.triangle_count() as usize);
        for (number, draw) in scene.draws.iter().enumerate() {
            let flags = material_flags(&scene.materials[draw.material as usize]);
            // The draw and the first index are kept in words 3 and 7 until the shading attributes are filled in.
            let range = draw.first_index as usize..(draw.first_index + draw.index_count) as usize;
            let record = |(i, triangle): (usize, &[u32])| {
                let corner = |k: usize| world(&draw.transform, scene.vertices[(draw.vertex_offset + triangle[k]) as usize].position);
                let first_index = draw.first_index + 3 * i as u32;
                let [a, b, c] = [corner(0), corner(1), corner(2)];
                [a[0], a[1], a[2], number as u32, b[0], b[1], b[2], first_index, c[0], c[1], c[2], flags]
            };
            records.par_extend(scene.indices[range].par_chunks_exact(3).enumerate().map(record));
        }
        let mut bvh = Self { nodes: vec![NOTHING], ..Self::default() };
        if records.is_empty() {
            return bvh;
        }
        let emits = |record: &&Triangle| scene.materials[scene.draws[record[3] as usize].material as usize].emission != [0.0; 3];
        let emitting: Vec<Triangle> = records.iter().filter(emits).copied().collect();
        let tree = tree(&records);
        bvh.set_grid(tree.nodes[0].aabb());
        bvh.lay_out(&tree, &records, 0);
        drop(tree);
        if !emitting.is_empty() && emitting.len() <= records.len() / FEW {
            drop(records);
            bvh.emitting = Emitting { root: bvh.nodes.len() as u32, first: bvh.triangles.len() };
            bvh.nodes.push(NOTHING);
            bvh.lay_out(&self::tree(&emitting), &emitting, bvh.emitting.root as usize);
        }
        bvh.add_looks(scene);
        bvh
    }

    /// Fills in shading attributes, colours and alpha tests, in the final order of the triangles.
    fn add_looks(&mut self, scene: &Scene) {
        let look = |record: &Triangle| {
            let draw = &scene.draws[record[3] as usize];
            let linear = draw.transform.matrix3;
            // The cofactor matrix transforms normals under any scale; the sign is the transform's own.
            let cofactor = Mat3A::from_cols(
                linear.y_axis.cross(linear.z_axis),
                linear.z_axis.cross(linear.x_axis),
                linear.x_axis.cross(linear.y_axis),
            );
            let orientation = if linear.x_axis.dot(cofactor.x_axis) < 0.0 { -1.0 } else { 1.0 };
            let mut words = [0; 12];
            for (k, vertex) in corner_vertices(scene, record).into_iter().enumerate() {
                let normal = cofactor * Vec3A::from(pack::octahedral_snorm16_inverse(vertex.normal)) * orientation;
                let (tangent, handedness) = pack::tangent_inverse(vertex.tangent);
                let tangent = Vec3::from(linear * Vec3A::from(tangent)).normalize_or(Vec3::X);
                let normal = pack::octahedral_snorm16(Vec3::from(normal).normalize_or(Vec3::Y));
                let [u, v] = vertex.uv.map(f32::to_bits);
                words[4 * k..][..4].copy_from_slice(&[normal, u, v, pack::tangent(tangent, handedness)]);
            }
            words
        };
        self.corners = self.triangles.par_iter().map(look).collect();
        if scene.vertices.iter().any(|vertex| vertex.color != u32::MAX) {
            let colors = |record: &Triangle| {
                let [a, b, c] = corner_vertices(scene, record).map(|vertex| vertex.color);
                [a, b, c, 0]
            };
            self.colors = self.triangles.par_iter().map(colors).collect();
        }
        let first = first_texels(scene);
        for record in &mut self.triangles {
            let material = scene.draws[record[3] as usize].material;
            if record[11] & flags::MASKED != 0 {
                record[11] |= (self.masks.len() as u32) << flags::MASK_SHIFT;
                self.masks.push(mask(scene, record, &scene.materials[material as usize], &first));
            }
            (record[3], record[7]) = (material, 0);
        }
    }
}

fn corner_vertices<'s>(scene: &'s Scene, record: &Triangle) -> [&'s Vertex; 3] {
    let (draw, first) = (&scene.draws[record[3] as usize], record[7] as usize);
    [0, 1, 2].map(|k| &scene.vertices[(draw.vertex_offset + scene.indices[first + k]) as usize])
}

fn mask(scene: &Scene, record: &Triangle, material: &Material, first: &[u32]) -> Mask {
    let corners = corner_vertices(scene, record);
    let map = material.base_color_map.unwrap_or_else(|| Map::new(0));
    let [a, b, c] = corners.map(|vertex| (map.matrix * Vec2::from(vertex.uv) + map.offset).to_array().map(f32::to_bits));
    let [texel, size, how] = texel_map(material.base_color_map, scene, first);
    let alpha = corners.iter().enumerate().fold(0, |word, (k, vertex)| word | (vertex.color >> 24) << (8 * k));
    let (factor, cutoff) = (material.base_color[3].to_bits(), material.alpha_cutoff.unwrap_or(0.0).to_bits());
    [a[0], a[1], b[0], b[1], c[0], c[1], texel, size, how, factor, alpha, cutoff]
}

const PARAMETERS: BvhBuildParams = BvhBuildParams {
    pre_split: false,
    ploc_search_distance: PlocSearchDistance::Low,
    search_depth_threshold: 2,
    reinsertion_batch_ratio: 0.3,
    post_collapse_reinsertion_batch_ratio_multiplier: 1.0,
    sort_precision: SortPrecision::U64,
    max_prims_per_leaf: MOST_IN_LEAF,
    collapse_traversal_cost: 1.0,
};

fn material_flags(material: &Material) -> u32 {
    let masked = if material.alpha_cutoff.is_some() { flags::MASKED } else { 0 };
    masked | if material.double_sided { 0 } else { flags::SINGLE_SIDED }
}

fn world(transform: &Affine3A, position: [f32; 3]) -> [u32; 3] {
    transform.transform_point3(position.into()).to_array().map(f32::to_bits)
}

/// Corners of a record.
fn corners(record: &Triangle) -> [Vec3A; 3] {
    [0, 4, 8].map(|at| Vec3A::from_array(std::array::from_fn(|axis| f32::from_bits(record[at + axis]))))
}

/// Builds the crate's tree of some triangles.
fn tree(records: &[Triangle]) -> Bvh2 {
    let corners: Vec<Bounded> = records.par_iter().map(|record| Bounded(corners(record))).collect();
    let tree = build_bvh2(&corners, PARAMETERS, &mut Duration::default());
    if tree.depth(0) <= STACK - 2 {
        return tree;
    }
    // Too deep: a chain of nested boxes, which only reinsertion makes, on unusual scenes. Without reinsertion the tree is shallower.
    build_bvh2(&corners, BvhBuildParams { reinsertion_batch_ratio: 0.0, ..PARAMETERS }, &mut Duration::default())
}

/// Grid cells a side.
const GRID: f32 = 65_535.0;

/// A node whose links end the traversal: the root of an empty tree, and the initial value of nodes.
const NOTHING: Node = [0, 0, 0, u32::MAX, 0, 0, 0, u32::MAX];

impl Bvh {
    /// Lays the grid over the bounds of all triangles.
    fn set_grid(&mut self, bounds: &BuildAabb) {
        let (min, max) = (Vec3::from(bounds.min), Vec3::from(bounds.max));
        // Cells of a flat scene need a height, too. Boxes are rounded outwards by up to two cells.
        let least = 1e-9 + min.abs().max(max.abs()).max_element() * 1e-6;
        self.cell = (max - min).max(Vec3::splat(least)) / (GRID - 4.0);
        self.origin = min - 2.0 * self.cell;
    }

    /// Converts the crate's tree into records below the node `top`, parents before children and siblings together.
    fn lay_out(&mut self, tree: &Bvh2, records: &[Triangle], top: usize) {
        self.depth = self.depth.max(tree.depth(0));
        self.triangles.reserve(records.len());
        let root = &tree.nodes[0];
        if root.is_leaf() {
            // Both children are the same leaf; a hit that is found twice counts once.
            let link = self.leaf(tree, records, 0);
            let child = self.child(root.aabb(), link);
            self.nodes[top][..4].copy_from_slice(&child);
            self.nodes[top][4..].copy_from_slice(&child);
            return;
        }
        self.nodes.reserve(tree.nodes.len() / 2 + 1);
        // Node of the crate's tree, and the number of its record.
        let mut open = vec![(0, top)];
        while let Some((from, to)) = open.pop() {
            let first: usize = tree.nodes[from].first_index as usize;
            for (half, which) in [first, first + 1].into_iter().enumerate() {
                let link = if tree.nodes[which].is_leaf() {
                    self.leaf(tree, records, which)
                } else {
                    self.nodes.push(NOTHING);
                    open.push((which, self.nodes.len() - 1));
                    self.nodes.len() as u32 - 1
                };
                let child = self.child(tree.nodes[which].aabb(), link);
                self.nodes[to][4 * half..][..4].copy_from_slice(&child);
            }
        }
    }

    /// Adds a leaf's triangles and returns the link to them.
    fn leaf(&mut self, tree: &Bvh2, records: &[Triangle], which: usize) -> u32 {
        let node = &tree.nodes[which];
        let (from, count) = (node.first_index as usize, node.prim_count);
        assert!((1..=MOST_IN_LEAF).contains(&count), "a leaf of {count} triangles");
        let first = self.triangles.len() as u32;
        self.triangles.extend(tree.primitive_indices[from..from + count as usize].iter().map(|i| records[*i as usize]));
        LEAF | (count - 1) << COUNT_SHIFT | first
    }

    /// One child's half of a node. Its box is rounded outwards, plus one cell against the traversal's rounding.
    fn child(&self, bounds: &BuildAabb, link: u32) -> [u32; 4] {
        let lower = ((Vec3::from(bounds.min) - self.origin) / self.cell - 1.0).floor().clamp(Vec3::ZERO, Vec3::splat(GRID));
        let upper = ((Vec3::from(bounds.max) - self.origin) / self.cell + 1.0).ceil().clamp(Vec3::ZERO, Vec3::splat(GRID));
        let word = |axis: usize| lower[axis] as u32 | (upper[axis] as u32) << 16;
        [word(0), word(1), word(2), link]
    }
}
