//! Draws merged into meshes in world space: one mesh per material, vertex colours and handedness.

use crate::scene::{Draw, Scene, pack};
use glam::{Mat3, Vec2, Vec3};
use std::collections::BTreeMap;

/// Properties shared by a mesh's triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Kind {
    /// Index into [`Scene::materials`].
    pub material: u32,
    /// Whether vertices are coloured.
    pub colored: bool,
    /// Whether the normal map is mirrored: the bitangent is against `cross(normal, tangent)`.
    pub left_handed: bool,
}

/// Triangles in world space.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    pub vertices: Vec<Corner>,
    /// Triangles, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner {
    pub position: Vec3,
    pub normal: Vec3,
    pub uv: Vec2,
    /// Linear RGBA, with the material's factor.
    pub color: [f32; 4],
}

/// All triangles of the scene; instances are copied.
pub fn merge(scene: &Scene) -> BTreeMap<Kind, Mesh> {
    let mut meshes: BTreeMap<Kind, Mesh> = BTreeMap::new();
    for draw in &scene.draws {
        let normal_map = scene.materials[draw.material as usize].normal_map.is_some();
        let colored = scene.draw_vertices(draw).any(|vertex| vertex.color != u32::MAX);
        let indices = &scene.indices[draw.first_index as usize..(draw.first_index + draw.index_count) as usize];
        let used = indices.iter().max().map_or(0, |most| *most as usize + 1);
        // New index of each vertex in the mesh of either handedness.
        let mut places = [vec![u32::MAX; used], vec![u32::MAX; if normal_map { used } else { 0 }]];
        for triangle in indices.chunks_exact(3) {
            let tangent = scene.vertices[(draw.vertex_offset + triangle[0]) as usize].tangent;
            let left_handed = normal_map && tangent >> 31 != 0;
            let mesh = meshes.entry(Kind { material: draw.material, colored, left_handed }).or_default();
            let places = &mut places[usize::from(left_handed)];
            let corners = std::array::from_fn(|i| {
                let place = &mut places[triangle[i] as usize];
                if *place == u32::MAX {
                    *place = mesh.vertices.len() as u32;
                    mesh.vertices.push(corner(scene, draw, triangle[i]));
                }
                *place
            });
            mesh.triangles.push(corners);
        }
    }
    meshes
}

fn corner(scene: &Scene, draw: &Draw, index: u32) -> Corner {
    let vertex = &scene.vertices[(draw.vertex_offset + index) as usize];
    let factor = scene.materials[draw.material as usize].base_color;
    let color = vertex.color.to_le_bytes();
    let linear = Mat3::from(draw.transform.matrix3);
    // Normals transform as in glsl/gbuffer/draw.vert: by the cofactor matrix, with the sign that keeps them on their side.
    let cofactor =
        Mat3::from_cols(linear.y_axis.cross(linear.z_axis), linear.z_axis.cross(linear.x_axis), linear.x_axis.cross(linear.y_axis));
    let orientation = if linear.x_axis.dot(cofactor.x_axis) < 0.0 { -1.0 } else { 1.0 };
    Corner {
        position: draw.transform.transform_point3(vertex.position.into()),
        normal: (cofactor * pack::octahedral_snorm16_inverse(vertex.normal) * orientation).normalize_or(Vec3::Y),
        uv: vertex.uv.into(),
        color: std::array::from_fn(|i| f32::from(color[i]) / 255.0 * factor[i]),
    }
}

impl Mesh {
    /// The back face: flipped, and `distance` behind, so that no ray hits both faces at once.
    pub fn back(&self, distance: f32) -> Self {
        let turned = |corner: &Corner| Corner { position: corner.position - corner.normal * distance, normal: -corner.normal, ..*corner };
        Self {
            vertices: self.vertices.iter().map(turned).collect(),
            triangles: self.triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, builder, builtin};
    use glam::Affine3A;

    #[test]
    fn a_merged_scene_has_all_triangles_where_the_draws_put_them() {
        let scene = builtin::cornell();
        let meshes = merge(&scene);
        assert_eq!(meshes.len(), 3, "a mesh for each colour");
        assert_eq!(meshes.values().map(|mesh| mesh.triangles.len() as u64).sum::<u64>(), scene.triangle_count());
        let corners = meshes.values().flat_map(|mesh| &mesh.vertices);
        let bounds = crate::scene::Aabb::of(corners.map(|corner| corner.position));
        assert_eq!(bounds, scene.bounds());
    }

    #[test]
    fn instances_are_written_out_with_their_normals() {
        let mut scene = Scene::default();
        let material = scene.add_material(Material::default());
        let mut quad = builder::Mesh::default();
        quad.quad([Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y], [Vec2::ZERO; 4]);
        let turn = Affine3A::from_rotation_y(std::f32::consts::FRAC_PI_2);
        scene.add_mesh(&quad, material, &[Affine3A::from_translation(Vec3::Z), turn]);
        let meshes = merge(&scene);
        let mesh = &meshes[&Kind { material, colored: false, left_handed: false }];
        assert_eq!((mesh.triangles.len(), mesh.vertices.len()), (4, 8));
        assert!(mesh.vertices[..4].iter().all(|corner| corner.position.z == 1.0 && corner.normal.distance(Vec3::Z) < 1e-4));
        assert!(mesh.vertices[4..].iter().all(|corner| corner.position.x.abs() < 1e-6 && corner.normal.distance(Vec3::X) < 1e-4));
        let back = mesh.back(0.5);
        assert_eq!(back.triangles[0], [0, 2, 1]);
        assert!((back.vertices[0].position.z - 0.5).abs() < 1e-4 && back.vertices[0].normal.z < -0.99);
    }
}
