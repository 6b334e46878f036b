//! Tangents for normal maps, by Mikkelsen's algorithm, which the tools that make normal maps use as well.

use super::{Map, Scene, Vertex, pack};
use bevy_mikktspace::{Geometry, TangentSpace};
use glam::{Vec2, Vec3};
use std::collections::{HashMap, HashSet};

/// Gives the vertices that normal-mapped materials draw their tangents, where they have none yet: a vertex whose `tangent`
/// is 0 has none, so a loader leaves those at 0 that its file is silent about.
///
/// A vertex whose triangles disagree (a seam, mirrored texture coordinates) is split: its copies go to the end of
/// [`Scene::vertices`]. An index range must not be drawn with two vertex offsets. Indices must be in range.
pub fn fill(scene: &mut Scene) {
    let mut done = HashSet::new();
    for i in 0..scene.draws.len() {
        let draw = &scene.draws[i];
        let range = (draw.first_index, draw.index_count, draw.vertex_offset);
        if let Some(map) = scene.materials[draw.material as usize].normal_map
            && done.insert(range)
        {
            fill_range(scene, range, map);
        }
    }
}

fn fill_range(scene: &mut Scene, (first_index, index_count, vertex_offset): (u32, u32, u32), map: Map) {
    let range = first_index as usize..(first_index + index_count) as usize;
    let indices: Vec<usize> = scene.indices[range.clone()].iter().map(|&i| (vertex_offset + i) as usize).collect();
    if indices.iter().all(|&i| scene.vertices[i].tangent != 0) {
        return;
    }
    let mut triangles = Triangles { vertices: &scene.vertices, indices: &indices, map, corners: vec![0; indices.len()] };
    if let Err(error) = bevy_mikktspace::generate_tangents(&mut triangles) {
        unreachable!("this version's error type has no values: {error}");
    }
    let corners = triangles.corners;

    // The first tangent that a vertex is given stays with it; others go to copies of it.
    let mut copies: HashMap<(usize, u32), u32> = HashMap::new();
    for (corner, (&vertex, &tangent)) in indices.iter().zip(&corners).enumerate() {
        let kept = scene.vertices[vertex].tangent;
        if kept == 0 {
            scene.vertices[vertex].tangent = tangent;
        } else if kept != tangent {
            scene.indices[range.start + corner] = *copies.entry((vertex, tangent)).or_insert_with(|| {
                let copy = Vertex { tangent, ..scene.vertices[vertex] };
                scene.vertices.push(copy);
                (scene.vertices.len() - 1) as u32 - vertex_offset
            });
        }
    }
}

struct Triangles<'a> {
    vertices: &'a [Vertex],
    /// Three a triangle, into `vertices`.
    indices: &'a [usize],
    map: Map,
    /// The packed tangent of each of them, never 0.
    corners: Vec<u32>,
}

impl Triangles<'_> {
    fn vertex(&self, face: usize, corner: usize) -> &Vertex {
        &self.vertices[self.indices[3 * face + corner]]
    }
}

impl Geometry for Triangles<'_> {
    fn num_faces(&self) -> usize {
        self.indices.len() / 3
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.vertex(face, corner).position
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        pack::octahedral_snorm16_inverse(self.vertex(face, corner).normal).into()
    }

    /// Where the map is looked up, with v upwards: glTF's normal maps have green point up in the image, while its v goes down.
    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = self.map.matrix * Vec2::from(self.vertex(face, corner).uv) + self.map.offset;
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let [x, y, z, handedness] = match space {
            Some(space) => space.tangent_encoded(),
            // A triangle without area, on its own or in texture space: any direction in its plane will do.
            None => pack::octahedral_snorm16_inverse(self.vertex(face, corner).normal).any_orthonormal_vector().extend(1.0).into(),
        };
        let normal = pack::octahedral_snorm16_inverse(self.vertex(face, corner).normal);
        let tangent = Vec3::new(x, y, z).try_normalize().unwrap_or_else(|| normal.any_orthonormal_vector());
        self.corners[3 * face + corner] = pack::tangent(tangent, handedness).max(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Material;
    use crate::scene::builder::Mesh;
    use glam::{Affine3A, Mat2};

    fn wall(uvs: [Vec2; 4]) -> (Mesh, Scene) {
        let mut mesh = Mesh::default();
        mesh.quad([Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y], uvs);
        let mut scene = Scene::default();
        scene.add_material(Material { normal_map: Some(Map::new(0)), ..Material::default() });
        (mesh, scene)
    }

    const UPRIGHT: [Vec2; 4] = [Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(1.0, 0.0), Vec2::new(0.0, 0.0)];

    fn unpacked(packed: u32) -> (Vec3, f32) {
        let p = Vec2::new((packed & 0x7fff) as f32, (packed >> 15 & 0x7fff) as f32) / 32767.0 * 2.0 - 1.0;
        (pack::octahedral_inverse(p), if packed >> 31 == 0 { 1.0 } else { -1.0 })
    }

    #[test]
    fn an_upright_picture_has_its_tangent_to_the_right_and_its_bitangent_up() {
        let (mesh, mut scene) = wall(UPRIGHT);
        scene.add_mesh(&mesh, 0, &[Affine3A::IDENTITY]);
        fill(&mut scene);
        for vertex in &scene.vertices {
            let (tangent, handedness) = unpacked(vertex.tangent);
            assert!(tangent.distance(Vec3::X) < 1e-3, "{tangent}");
            assert!((handedness * Vec3::Z.cross(tangent)).distance(Vec3::Y) < 1e-3);
        }
    }

    #[test]
    fn a_mirrored_picture_has_the_other_handedness() {
        let (mesh, mut scene) = wall(UPRIGHT.map(|uv| Vec2::new(1.0 - uv.x, uv.y)));
        scene.add_mesh(&mesh, 0, &[Affine3A::IDENTITY]);
        fill(&mut scene);
        let (tangent, handedness) = unpacked(scene.vertices[0].tangent);
        assert!(tangent.distance(Vec3::NEG_X) < 1e-3 && handedness < 0.0, "{tangent} {handedness}");
    }

    #[test]
    fn a_picture_that_its_map_turns_has_its_tangent_turned() {
        let (mesh, mut scene) = wall(UPRIGHT);
        // u becomes v, and the picture's right goes down the wall.
        scene.materials[0].normal_map = Some(Map { matrix: Mat2::from_cols(Vec2::Y, Vec2::X), ..Map::new(0) });
        scene.add_mesh(&mesh, 0, &[Affine3A::IDENTITY]);
        fill(&mut scene);
        let (tangent, handedness) = unpacked(scene.vertices[0].tangent);
        assert!(tangent.distance(Vec3::NEG_Y) < 1e-3 && handedness < 0.0, "{tangent} {handedness}");
    }

    #[test]
    fn vertices_between_mirrored_halves_are_split_and_draws_keep_sharing_them() {
        // Two quads that share an edge, the picture mirrored across it.
        let (mut mesh, mut scene) = wall(UPRIGHT);
        let far = [Vec3::new(2.0, 0.0, 0.0), Vec3::new(2.0, 1.0, 0.0)];
        let c = mesh.vertex(far[0], Vec3::Z, Vec2::new(0.0, 1.0));
        let d = mesh.vertex(far[1], Vec3::Z, Vec2::new(0.0, 0.0));
        mesh.indices.extend([1, c, d, 1, d, 2]);
        scene.add_mesh(&mesh, 0, &[Affine3A::IDENTITY, Affine3A::from_translation(Vec3::Z)]);
        fill(&mut scene);
        assert_eq!(scene.vertices.len(), 8, "the two vertices of the shared edge get one copy each");
        assert_eq!(scene.draws[0].first_index, scene.draws[1].first_index);
        for (t, triangle) in scene.indices.chunks(3).enumerate() {
            for &i in triangle {
                assert_eq!(unpacked(scene.vertices[i as usize].tangent).1 > 0.0, t < 2, "triangle {t}");
            }
        }
        let again = scene.clone();
        fill(&mut scene);
        assert_eq!(again.vertices, scene.vertices, "a second time changes nothing");
    }

    #[test]
    fn tangents_of_a_file_are_kept_and_triangles_without_texture_space_get_finite_ones() {
        let (mesh, mut scene) = wall(UPRIGHT);
        scene.add_mesh(&mesh, 0, &[Affine3A::IDENTITY]);
        scene.vertices.iter_mut().for_each(|v| v.tangent = 42);
        fill(&mut scene);
        assert!(scene.vertices.iter().all(|v| v.tangent == 42));

        let (mesh, mut scene) = wall([Vec2::ZERO; 4]);
        scene.add_mesh(&mesh, 0, &[Affine3A::IDENTITY]);
        fill(&mut scene);
        for vertex in &scene.vertices {
            let (tangent, _) = unpacked(vertex.tangent);
            assert!(vertex.tangent != 0 && tangent.z.abs() < 1e-3, "{tangent} is in the plane");
        }
    }
}
