//! Tangents for normal maps that come without, as the tools that bake such maps make them (MikkTSpace).

use super::{Vertex, pack};
use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Gives every vertex of these triangles a tangent. A vertex at which tangents differ from triangle to triangle, as at a seam
/// of mirrored texture coordinates, is split: vertices are added, and indices changed.
///
/// `uv` takes a vertex's texture coordinates to those at which the normal map is looked up.
pub fn fill(vertices: &mut Vec<Vertex>, indices: &mut [u32], uv: impl Fn(Vec2) -> Vec2) {
    let mut corners = Corners { vertices, indices, uv, tangents: vec![0; indices.len()] };
    let Ok(()) = generate_tangents(&mut corners) else {
        unreachable!("the algorithm has no errors");
    };
    let tangents = corners.tangents;
    let mut split = HashMap::new();
    let mut used = vec![false; vertices.len()];
    for (index, tangent) in indices.iter_mut().zip(tangents) {
        *index = *split.entry((*index, tangent)).or_insert_with(|| {
            let old = *index as usize;
            if std::mem::replace(&mut used[old], true) {
                vertices.push(Vertex { tangent, ..vertices[old] });
                vertices.len() as u32 - 1
            } else {
                vertices[old].tangent = tangent;
                *index
            }
        });
    }
}

struct Corners<'a, F> {
    vertices: &'a [Vertex],
    indices: &'a [u32],
    uv: F,
    /// Packed, one a corner.
    tangents: Vec<u32>,
}

impl<F> Corners<'_, F> {
    fn vertex(&self, face: usize, corner: usize) -> &Vertex {
        &self.vertices[self.indices[3 * face + corner] as usize]
    }
}

impl<F: Fn(Vec2) -> Vec2> Geometry for Corners<'_, F> {
    fn num_faces(&self) -> usize {
        self.indices.len() / 3
    }

    fn num_vertices_of_face(&self, _: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.vertex(face, corner).position
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        pack::octahedral_snorm16_inverse(self.vertex(face, corner).normal).into()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        (self.uv)(self.vertex(face, corner).uv.into()).into()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        let normal = Vec3::from(self.normal(face, corner));
        let [x, y, z, sign] = space.unwrap_or_default().tangent_encoded();
        // Without texture coordinates that span an area, any tangent is as good as another.
        let tangent = Vec3::new(x, y, z).reject_from_normalized(normal).try_normalize();
        let tangent = tangent.unwrap_or_else(|| normal.any_orthonormal_vector());
        // The algorithm takes v to go up, glTF's goes down.
        self.tangents[3 * face + corner] = pack::tangent(tangent, -sign);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertex(position: [f32; 3], uv: [f32; 2]) -> Vertex {
        Vertex { position, normal: pack::octahedral_snorm16(Vec3::Z), uv, color: u32::MAX, tangent: 0 }
    }

    /// A square in the plane z = 0 that faces +z, u to the right and v downwards, as an image that hangs on a wall.
    fn square() -> Vec<Vertex> {
        vec![
            vertex([0.0, 0.0, 0.0], [0.0, 1.0]),
            vertex([1.0, 0.0, 0.0], [1.0, 1.0]),
            vertex([1.0, 1.0, 0.0], [1.0, 0.0]),
            vertex([0.0, 1.0, 0.0], [0.0, 0.0]),
        ]
    }

    #[test]
    fn an_image_on_a_wall_has_its_tangent_to_the_right_and_its_bitangent_up() {
        let mut vertices = square();
        fill(&mut vertices, &mut [0, 1, 2, 0, 2, 3], |uv| uv);
        assert_eq!(vertices.len(), 4);
        // cross(+z, +x) is +y, which is up: the handedness is positive.
        assert!(vertices.iter().all(|v| v.tangent == pack::tangent(Vec3::X, 1.0)), "{vertices:?}");
    }

    #[test]
    fn a_map_that_is_turned_turns_its_tangents() {
        let mut vertices = square();
        fill(&mut vertices, &mut [0, 1, 2, 0, 2, 3], |uv| Vec2::new(uv.y, uv.x));
        assert!(vertices.iter().all(|v| v.tangent == pack::tangent(Vec3::NEG_Y, -1.0)), "{vertices:?}");
    }

    #[test]
    fn a_seam_of_mirrored_coordinates_splits_its_vertices() {
        let mut vertices = square();
        // The mirror image to the right of the square, with two corners in common.
        vertices.extend([vertex([2.0, 0.0, 0.0], [0.0, 1.0]), vertex([2.0, 1.0, 0.0], [0.0, 0.0])]);
        let mut indices = [0, 1, 2, 0, 2, 3, 1, 4, 5, 1, 5, 2];
        fill(&mut vertices, &mut indices, |uv| uv);
        assert_eq!(vertices.len(), 8);
        for (i, index) in indices.into_iter().enumerate() {
            let expected = if i < 6 { pack::tangent(Vec3::X, 1.0) } else { pack::tangent(Vec3::NEG_X, -1.0) };
            assert_eq!(vertices[index as usize].tangent, expected, "corner {i}");
        }
    }

    #[test]
    fn triangles_without_an_area_in_the_texture_still_get_a_tangent() {
        let mut vertices = square();
        fill(&mut vertices, &mut [0, 1, 2, 0, 2, 3], |_| Vec2::ZERO);
        assert!(vertices.iter().all(|v| v.tangent != 0));
    }
}
