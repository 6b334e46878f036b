//! Adding meshes to the scene's one vertex and one index array, with a draw per node.

use super::accessors::Attribute;
use super::bends::{BendKey, Bends, number, restore};
use super::materials::{Materials, Used};
use super::nodes::PlacedMesh;
use super::triangles::{make_flat, triangulate};
use super::{File, Warning, Warnings, label, refuse};
use crate::scene::animation::Hung;
use crate::scene::bend::Bending;
use crate::scene::{Aabb, Draw, Map, Scene, Vertex, pack, tangents};
use anyhow::{Context, Result};
use glam::{Vec3, Vec4};
use gltf_json::accessor::Accessor;
use gltf_json::mesh::{Mode, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Index, Mesh};
use std::collections::HashMap;

/// Limit of distances from the origin, m: beyond it, single precision has steps of more than 50 m.
pub const MAX_DISTANCE: f32 = 1e9;
/// Limit of primitives over all nodes: a small file in which many nodes show many primitives would fill the memory with draws.
const MAX_SHOWN: usize = 1 << 20;
/// Limits of a scene's vertices and indices (2 GiB each).
pub const MAX_VERTICES: usize = 1 << 26;
const MAX_INDICES: usize = 1 << 29;

/// All inputs of a range of vertices. Primitives with equal keys share the range.
#[derive(Clone, PartialEq, Eq, Hash)]
struct VertexKey {
    positions: usize,
    normals: Option<usize>,
    tangents: Option<usize>,
    uvs: Option<(u32, usize)>,
    colors: Option<usize>,
    /// The handedness of given tangents is flipped, since a mirrored node swaps it.
    mirrored_tangents: bool,
    /// Inputs of vertices made per corner: flat normals and tangents depend on the triangles.
    corners: Option<Corners>,
    bend: BendKey,
}

#[derive(Clone, PartialEq, Eq, Hash)]
struct Corners {
    indices: Option<usize>,
    mode: u8,
    mirrored: bool,
    /// Material of the normal map, if tangents are made for it.
    material: Option<u32>,
}

#[derive(Clone, PartialEq, Eq, Hash)]
struct IndexKey {
    vertices: VertexKey,
    indices: Option<usize>,
    mode: u8,
    mirrored: bool,
}

/// A range of vertices, in the scene, or as modelled of the meshes that bend.
#[derive(Clone, Copy)]
struct Vertices {
    offset: u32,
    count: u32,
    /// Number of what nodes get copies of, if it bends.
    template: Option<usize>,
}

/// A range of triangles and its bounds, in mesh space.
#[derive(Clone, Copy)]
struct Triangles {
    vertices: Vertices,
    first_index: u32,
    index_count: u32,
    bounds: Aabb,
}

struct Builder<'a> {
    file: &'a File<'a>,
    scene: &'a mut Scene,
    warnings: &'a mut Warnings,
    vertices: HashMap<VertexKey, Vertices>,
    triangles: HashMap<IndexKey, Option<Triangles>>,
    bends: Bends<'a>,
    /// Primitives counted so far, over all nodes.
    shown: usize,
}

/// Adds all meshes to the scene. Those that bend are in it as they were modelled; the result says how they bend.
pub fn build<'a>(
    file: &'a File<'_>,
    meshes: &[PlacedMesh],
    materials: &Materials,
    bends: Bends<'a>,
    scene: &'a mut Scene,
    warnings: &'a mut Warnings,
) -> Result<Bending> {
    let mut builder = Builder { file, scene, warnings, vertices: HashMap::new(), triangles: HashMap::new(), bends, shown: 0 };
    for placed in meshes {
        let mesh = file.get(placed.mesh, "mesh")?;
        builder.mesh(mesh, placed, materials).with_context(|| label("mesh", placed.mesh.value(), mesh.name.as_ref()))?;
    }
    Ok(builder.bends.made)
}

/// Whether all coordinates of a box are within [`MAX_DISTANCE`]; NaN is not.
pub fn is_near(bounds: Aabb) -> bool {
    [bounds.min, bounds.max].iter().all(|corner| corner.abs().cmple(Vec3::splat(MAX_DISTANCE)).all())
}

impl Builder<'_> {
    fn mesh(&mut self, mesh: &Mesh, placed: &PlacedMesh, materials: &Materials) -> Result<()> {
        for (i, primitive) in mesh.primitives.iter().enumerate() {
            self.shown += 1;
            if self.shown > MAX_SHOWN {
                refuse!("the nodes show more than {MAX_SHOWN} primitives");
            }
            let material = materials.get(primitive.material);
            let context = || format!("primitive {i}");
            let Some(triangles) = self.primitive(mesh, primitive, material, placed).with_context(context)? else {
                continue;
            };
            let vertex_offset = match triangles.vertices.template {
                Some(template) => self.bends.copy(template, mesh, placed, self.scene).with_context(context)?,
                None => triangles.vertices.offset,
            };
            if triangles.vertices.template.is_none() && !is_near(triangles.bounds.transformed(&placed.transform)) {
                refuse!("at node {} it reaches farther than {MAX_DISTANCE:e} m from the origin", placed.node);
            }
            if let (Some(node), Some(animation)) = (placed.moves, &mut self.scene.animation) {
                animation.draws.push(Hung { index: self.scene.draws.len(), node });
            }
            self.scene.draws.push(Draw {
                first_index: triangles.first_index,
                index_count: triangles.index_count,
                vertex_offset,
                material: material.index,
                transform: placed.transform,
            });
        }
        Ok(())
    }

    /// The range of a primitive's triangles; `None` if it has no triangles.
    fn primitive(&mut self, mesh: &Mesh, primitive: &Primitive, material: Used, placed: &PlacedMesh) -> Result<Option<Triangles>> {
        let mirrored = placed.mirrored;
        let Checked::Valid(mode) = primitive.mode else {
            refuse!("its mode is none of glTF's");
        };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.warnings.add(Warning::PointsAndLines, "points and lines are not supported: they are left out");
            return Ok(None);
        }
        let attribute = |semantic: Semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let Some(positions) = attribute(Semantic::Positions) else {
            refuse!("it has no POSITION");
        };
        let uvs = attribute(Semantic::TexCoords(material.uv_set));
        if uvs.is_none() && material.has_maps {
            let (name, set) = (&self.scene.materials[material.index as usize].name, material.uv_set);
            let sentence =
                format!("material {name:?} has textures at TEXCOORD_{set}, which a mesh lacks: it shows their first texel there");
            self.warnings.add(Warning::NoUvs, sentence);
        }
        let normals = attribute(Semantic::Normals);
        // Given tangents are meaningless without normals.
        let tangents = attribute(Semantic::Tangents).filter(|_| material.has_normal_map && normals.is_some());
        let makes_tangents = material.has_normal_map && tangents.is_none();
        if material.has_normal_map && primitive.targets.iter().flatten().any(|target| target.tangents.is_some()) {
            self.warnings.add(Warning::MorphTangents, "TANGENT of morph targets is not supported: tangents keep their direction");
        }
        let bend = self.bends.key(mesh, primitive, placed, self.warnings)?;
        let value = |index: Index<Accessor>| index.value();
        let (indices, mode_number) = (primitive.indices.map(value), mode as u8);
        let corners = (normals.is_none() || makes_tangents).then(|| Corners {
            indices,
            mode: mode_number,
            mirrored,
            material: makes_tangents.then_some(material.index),
        });
        let vertices = VertexKey {
            positions: value(positions),
            normals: normals.map(value),
            tangents: tangents.map(value),
            uvs: uvs.map(|uvs| (material.uv_set, value(uvs))),
            colors: attribute(Semantic::Colors(0)).map(value),
            mirrored_tangents: mirrored && material.has_normal_map,
            corners,
            bend,
        };
        let key = IndexKey { vertices, indices, mode: mode_number, mirrored };
        if let Some(known) = self.triangles.get(&key) {
            return Ok(*known);
        }
        let made = self.triangles(&key, mode)?;
        self.triangles.insert(key, made);
        Ok(made)
    }

    fn triangles(&mut self, key: &IndexKey, mode: Mode) -> Result<Option<Triangles>> {
        let count = self.file.count(Index::new(key.vertices.positions as u32))?;
        let mut indices = match key.indices {
            Some(indices) => {
                let list = self.file.indices(Index::new(indices as u32))?;
                if let Some(bad) = list.iter().find(|&&i| u64::from(i) >= count) {
                    refuse!("its indices (accessor {indices}) name vertex {bad}, it has {count}");
                }
                triangulate(list.len(), mode, |i| list[i])
            }
            None => {
                // The positions are read first, which checks the count against the bytes of the file.
                self.file.floats::<3>(Index::new(key.vertices.positions as u32), Attribute::Position)?;
                triangulate(usize::try_from(count)?, mode, |i| i as u32)
            }
        };
        let mut own = key.vertices.corners.as_ref().map(|_| self.read_vertices(&key.vertices)).transpose()?;
        let colors = own.as_mut().filter(|_| key.vertices.bend.bends()).map(|vertices| number(vertices));
        if let Some(vertices) = own.as_mut().filter(|_| key.vertices.normals.is_none()) {
            make_flat(vertices, &mut indices);
        }
        if key.mirrored {
            indices.as_chunks_mut::<3>().0.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
        }
        // Tangents follow the corners' present order: a mirrored node's order flips the handedness too.
        if let Some((vertices, map)) = own.as_mut().zip(self.map_without_tangents(&key.vertices)) {
            tangents::fill(vertices, &mut indices, |uv| map.matrix * uv + map.offset);
        }
        let range = match own {
            Some(mut vertices) => {
                let sources = colors.map(|colors| restore(&mut vertices, &colors)).unwrap_or_default();
                self.append(&key.vertices.bend, vertices, (count as usize, &sources))?
            }
            None => self.shared_vertices(&key.vertices)?,
        };
        if indices.is_empty() {
            return Ok(None);
        }
        let vertices = if range.template.is_some() { &self.bends.made.rest } else { &self.scene.vertices };
        let vertices = &vertices[range.offset as usize..][..range.count as usize];
        let bounds = Aabb::of(indices.iter().map(|&i| vertices[i as usize].position.into()));
        let (first_index, index_count) = (self.scene.indices.len(), indices.len());
        if first_index + index_count > MAX_INDICES {
            refuse!("with it, the scene has more than {MAX_INDICES} indices");
        }
        self.scene.indices.append(&mut indices);
        Ok(Some(Triangles { vertices: range, first_index: first_index as u32, index_count: index_count as u32, bounds }))
    }

    /// The normal map for which tangents must be made.
    fn map_without_tangents(&self, key: &VertexKey) -> Option<Map> {
        self.scene.materials[key.corners.as_ref()?.material? as usize].normal_map
    }

    /// The range of vertices shared by primitives with the same attributes.
    fn shared_vertices(&mut self, key: &VertexKey) -> Result<Vertices> {
        if let Some(known) = self.vertices.get(key) {
            return Ok(*known);
        }
        let vertices = self.read_vertices(key)?;
        let sources: Vec<u32> = if key.bend.bends() { (0..vertices.len() as u32).collect() } else { Vec::new() };
        let range = self.append(&key.bend, vertices, (sources.len(), &sources))?;
        self.vertices.insert(key.clone(), range);
        Ok(range)
    }

    /// Adds vertices; if they bend, `sources` are as in [`Bends::add`].
    fn append(&mut self, bend: &BendKey, mut vertices: Vec<Vertex>, sources: (usize, &[u32])) -> Result<Vertices> {
        if bend.bends() {
            let (offset, count) = (self.bends.made.rest.len() as u32, vertices.len() as u32);
            let template = Some(self.bends.add(bend, vertices, sources, self.warnings)?);
            return Ok(Vertices { offset, count, template });
        }
        let (offset, count) = (self.scene.vertices.len(), vertices.len());
        if offset + count > MAX_VERTICES {
            refuse!("with it, the scene has more than {MAX_VERTICES} vertices");
        }
        self.scene.vertices.append(&mut vertices);
        Ok(Vertices { offset: offset as u32, count: count as u32, template: None })
    }

    /// Vertices from the file. Without normals in the file they point up.
    fn read_vertices(&mut self, key: &VertexKey) -> Result<Vec<Vertex>> {
        let file = self.file;
        let positions: Vec<[f32; 3]> = read(file, Some(key.positions), Attribute::Position, None)?;
        let count = Some(positions.len());
        let normals: Vec<[f32; 3]> = read(file, key.normals, Attribute::Normal, count)?;
        let uvs: Vec<[f32; 2]> = read(file, key.uvs.map(|(_, uvs)| uvs), Attribute::TexCoord(key.uvs.map_or(0, |(set, _)| set)), count)?;
        let colors: Vec<[f32; 4]> = read(file, key.colors, Attribute::Color, count)?;
        let tangents: Vec<[f32; 4]> = read(file, key.tangents, Attribute::Tangent, count)?;
        let handedness = if key.mirrored_tangents { -1.0 } else { 1.0 };
        let mut invalid_normals = 0usize;
        let vertices = positions.iter().enumerate().map(|(i, &position)| {
            let normal = normals.get(i).map_or(Vec3::Y, |&normal| {
                Vec3::from(normal).try_normalize().unwrap_or_else(|| {
                    invalid_normals += 1;
                    Vec3::Y
                })
            });
            let tangent = tangents.get(i).map_or(0, |&tangent| {
                let tangent = Vec4::from(tangent);
                let direction = tangent.truncate().try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
                pack::tangent(direction, tangent.w * handedness)
            });
            Vertex {
                position,
                normal: pack::octahedral_snorm16(normal),
                uv: uvs.get(i).copied().unwrap_or_default(),
                color: colors.get(i).map_or(u32::MAX, |&color| pack::unorm8x4(color)),
                tangent,
            }
        });
        let vertices = vertices.collect();
        if invalid_normals > 0 {
            self.warnings.add(Warning::Normals, "some normals have no length: they are taken to point upwards");
        }
        Ok(vertices)
    }
}

/// An attribute of `count` elements; empty if it is missing.
pub fn read<const N: usize>(file: &File<'_>, index: Option<usize>, attribute: Attribute, count: Option<usize>) -> Result<Vec<[f32; N]>> {
    let Some(index) = index else {
        return Ok(Vec::new());
    };
    let elements = file.floats(Index::new(index as u32), attribute)?;
    if let Some(count) = count.filter(|&count| count != elements.len()) {
        refuse!("its {attribute} has {} elements, its POSITION {count}", elements.len());
    }
    Ok(elements)
}
