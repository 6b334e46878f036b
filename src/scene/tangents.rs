//! Tangents for normal maps by Mikkelsen's algorithm (MikkTSpace), as the tools that bake normal maps compute them.

use super::{Vertex, pack};
use bevy_mikktspace::{Geometry, TangentSpace};
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Computes the tangents of these triangles' vertices. A vertex whose triangles disagree (a seam, mirrored texture coordinates)
/// is split: its copies are appended to `vertices`, and indices change. Indices must be in range.
///
/// `uv` transforms a vertex's texture coordinates to those of the normal map.
pub fn fill(vertices: &mut Vec<Vertex>, indices: &mut [u32], uv: impl Fn(Vec2) -> Vec2) {
    let mut triangles = Triangles { vertices, indices, uv, corners: vec![0; indices.len()] };
    if let Err(error) = bevy_mikktspace::generate_tangents(&mut triangles) {
        unreachable!("this version's error type has no values: {error}");
    }
    let corners = triangles.corners;

    // A vertex keeps the first tangent it gets; other tangents go to copies.
    let mut first = vec![false; vertices.len()];
    let mut copies: HashMap<(u32, u32), u32> = HashMap::new();
    for (index, &tangent) in indices.iter_mut().zip(&corners) {
        let vertex = *index as usize;
        if !std::mem::replace(&mut first[vertex], true) {
            vertices[vertex].tangent = tangent;
        } else if vertices[vertex].tangent != tangent {
            *index = *copies.entry((*index, tangent)).or_insert_with(|| {
                vertices.push(Vertex { tangent, ..vertices[vertex] });
                vertices.len() as u32 - 1
            });
        }
    }
}

struct Triangles<'a, F> {
    vertices: &'a [Vertex],
    /// Three indices per triangle.
    indices: &'a [u32],
    uv: F,
    /// Packed tangent of each corner.
    corners: Vec<u32>,
}

impl<F> Triangles<'_, F> {
    fn vertex(&self, face: usize, corner: usize) -> &Vertex {
        &self.vertices[self.indices[3 * face + corner] as usize]
    }
}

impl<F: Fn(Vec2) -> Vec2> Geometry for Triangles<'_, F> {
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

    /// v is flipped to point up: in glTF's normal maps green points up in the image, while v goes down.
    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let uv = (self.uv)(self.vertex(face, corner).uv.into());
        [uv.x, 1.0 - uv.y]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let normal = Vec3::from(self.normal(face, corner));
        let [x, y, z, handedness] = space.map_or([0.0, 0.0, 0.0, 1.0], |space| space.tangent_encoded());
        // A triangle without area in space or in texture space has no tangent; any direction in its plane will do.
        let tangent = Vec3::new(x, y, z).reject_from_normalized(normal).try_normalize();
        let tangent = tangent.unwrap_or_else(|| normal.any_orthonormal_vector());
        self.corners[3 * face + corner] = pack::tangent(tangent, handedness);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UPRIGHT: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];

    /// A square of 1 m in the xy plane, facing +z.
    fn wall(uvs: [[f32; 2]; 4]) -> (Vec<Vertex>, Vec<u32>) {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let normal = pack::octahedral_snorm16(Vec3::Z);
        let vertex = |i: usize| Vertex { position: corners[i], normal, uv: uvs[i], color: u32::MAX, tangent: 0 };
        (Vec::from_iter((0..4).map(vertex)), vec![0, 1, 2, 0, 2, 3])
    }

    fn unpacked(packed: u32) -> (Vec3, f32) {
        let p = Vec2::new((packed & 0x7fff) as f32, (packed >> 15 & 0x7fff) as f32) / 32767.0 * 2.0 - 1.0;
        (pack::octahedral_inverse(p), if packed >> 31 == 0 { 1.0 } else { -1.0 })
    }

    #[test]
    fn an_upright_picture_has_its_tangent_to_the_right_and_its_bitangent_up() {
        let (mut vertices, mut indices) = wall(UPRIGHT);
        fill(&mut vertices, &mut indices, |uv| uv);
        for vertex in &vertices {
            let (tangent, handedness) = unpacked(vertex.tangent);
            assert!(tangent.distance(Vec3::X) < 1e-3, "{tangent}");
            assert!((handedness * Vec3::Z.cross(tangent)).distance(Vec3::Y) < 1e-3);
        }
    }

    #[test]
    fn a_mirrored_or_turned_look_up_turns_the_tangent() {
        let (mut vertices, mut indices) = wall(UPRIGHT);
        fill(&mut vertices, &mut indices, |uv| Vec2::new(1.0 - uv.x, uv.y));
        let (tangent, handedness) = unpacked(vertices[0].tangent);
        assert!(tangent.distance(Vec3::NEG_X) < 1e-3 && handedness < 0.0, "{tangent} {handedness}");
        fill(&mut vertices, &mut indices, |uv| Vec2::new(1.0 - uv.y, uv.x));
        let (tangent, handedness) = unpacked(vertices[0].tangent);
        assert!(tangent.distance(Vec3::Y) < 1e-3 && handedness > 0.0, "{tangent} {handedness}");
    }

    #[test]
    fn vertices_between_mirrored_halves_are_split() {
        // Two squares share an edge, and the texture is mirrored across it.
        let (mut vertices, mut indices) = wall(UPRIGHT);
        for (x, y) in [(2.0, 0.0), (2.0, 1.0)] {
            vertices.push(Vertex { position: [x, y, 0.0], uv: [0.0, 1.0 - y], ..vertices[0] });
        }
        indices.extend([1, 4, 5, 1, 5, 2]);
        fill(&mut vertices, &mut indices, |uv| uv);
        assert_eq!(vertices.len(), 8, "the two vertices of the shared edge get one copy each");
        for (t, triangle) in indices.chunks(3).enumerate() {
            for &i in triangle {
                assert_eq!(unpacked(vertices[i as usize].tangent).1 > 0.0, t < 2, "triangle {t}");
            }
        }
    }

    #[test]
    fn triangles_without_texture_space_get_a_tangent_in_their_plane() {
        let (mut vertices, mut indices) = wall([[0.5; 2]; 4]);
        fill(&mut vertices, &mut indices, |uv| uv);
        for vertex in &vertices {
            let (tangent, _) = unpacked(vertex.tangent);
            assert!(tangent.z.abs() < 1e-3 && (tangent.length() - 1.0).abs() < 1e-3, "{tangent}");
        }
    }
}
