//! Triangles of lists, strips and fans, and their flat normals.

use crate::scene::{Vertex, pack};
use glam::Vec3;
use gltf_json::mesh::Mode;

/// Vertex indices of the triangles of `count` vertices. Triangles with repeated indices are left out: strips use them as
/// joints.
pub fn triangulate(count: usize, mode: Mode, index: impl Fn(usize) -> u32) -> Vec<u32> {
    let triangles = if mode == Mode::Triangles { count / 3 } else { count.saturating_sub(2) };
    let mut indices = Vec::with_capacity(3 * triangles);
    for i in 0..triangles {
        let corners = match mode {
            Mode::TriangleStrip => [i, i + 1 + i % 2, i + 2 - i % 2],
            Mode::TriangleFan => [i + 1, i + 2, 0],
            _ => [3 * i, 3 * i + 1, 3 * i + 2],
        };
        let [a, b, c] = corners.map(&index);
        if a != b && b != c && c != a {
            indices.extend([a, b, c]);
        }
    }
    indices
}

/// Gives every corner its own vertex with the triangle's normal. Triangles without area have no normal, and are left out.
pub fn make_flat(vertices: &mut Vec<Vertex>, indices: &mut Vec<u32>) {
    let mut flat = Vec::with_capacity(indices.len());
    for corners in indices.as_chunks::<3>().0 {
        let corners = corners.map(|i| vertices[i as usize]);
        let [a, b, c] = corners.map(|vertex| Vec3::from(vertex.position).as_dvec3());
        if let Some(normal) = (b - a).cross(c - a).try_normalize() {
            let normal = pack::octahedral_snorm16(normal.as_vec3());
            flat.extend(corners.map(|vertex| Vertex { normal, ..vertex }));
        }
    }
    *indices = (0..flat.len() as u32).collect();
    *vertices = flat;
}
