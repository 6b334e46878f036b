//! Adding meshes to a [`Scene`]'s one vertex and one index array.

use super::{Draw, Material, Scene, Texture, Vertex, pack, tangents};
use glam::{Affine3A, Vec2, Vec3};

/// A mesh under construction: position, unit normal and texture coordinate of each vertex.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    pub positions: Vec<Vec3>,
    pub normals: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    pub indices: Vec<u32>,
}

impl Mesh {
    pub fn vertex(&mut self, position: Vec3, normal: Vec3, uv: Vec2) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        self.uvs.push(uv);
        self.positions.len() as u32 - 1
    }

    /// A flat quadrilateral, corners counter-clockwise seen from its front.
    pub fn quad(&mut self, corners: [Vec3; 4], uvs: [Vec2; 4]) {
        let normal = (corners[1] - corners[0]).cross(corners[3] - corners[0]).normalize();
        let [a, b, c, d] = std::array::from_fn(|i| self.vertex(corners[i], normal, uvs[i]));
        self.indices.extend([a, b, c, a, c, d]);
    }

    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }
}

impl Scene {
    /// Adds a texture and returns its index.
    pub fn add_texture(&mut self, texture: Texture) -> u32 {
        self.textures.push(texture);
        self.textures.len() as u32 - 1
    }

    /// Adds a material and returns its index.
    pub fn add_material(&mut self, material: Material) -> u32 {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }

    /// Adds a mesh's triangles and draws them once at each of `transforms`; a mesh without triangles adds nothing. If the
    /// material has a normal map, the vertices get tangents.
    pub fn add_mesh(&mut self, mesh: &Mesh, material: u32, transforms: &[Affine3A]) {
        if mesh.indices.is_empty() {
            return;
        }
        let (vertex_offset, first_index) = (self.vertices.len() as u32, self.indices.len() as u32);
        let mut vertices: Vec<_> = (0..mesh.positions.len())
            .map(|i| Vertex {
                position: mesh.positions[i].into(),
                normal: pack::octahedral_snorm16(mesh.normals[i]),
                uv: mesh.uvs[i].into(),
                color: u32::MAX,
                tangent: 0,
            })
            .collect();
        let mut indices = mesh.indices.clone();
        if let Some(map) = self.materials[material as usize].normal_map {
            tangents::fill(&mut vertices, &mut indices, |uv| map.matrix * uv + map.offset);
        }
        self.vertices.append(&mut vertices);
        self.indices.append(&mut indices);
        self.draws.extend(transforms.iter().map(|&transform| Draw {
            first_index,
            index_count: mesh.indices.len() as u32,
            vertex_offset,
            material,
            transform,
        }));
    }
}
