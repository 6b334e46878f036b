//! Triangles in a coherent order: passes that take a run of consecutive triangles find them close together.

use super::{Scene, Vertex};
use glam::{UVec3, Vec3};
use std::collections::BTreeMap;

/// Cells per axis of a mesh's bounds: 10 bits, so that three fill 30 bits of a key.
const CELLS: f32 = 1024.0;

impl Scene {
    /// Sorts the triangles of each mesh along a Morton curve through their centroids.
    pub fn sort_triangles(&mut self) {
        let ranges: BTreeMap<u32, (u32, u32)> =
            self.draws.iter().map(|draw| (draw.first_index, (draw.index_count, draw.vertex_offset))).collect();
        let Self { vertices, indices, .. } = self;
        for (first, (count, offset)) in ranges {
            sort_triangles(&vertices[offset as usize..], &mut indices[first as usize..(first + count) as usize]);
        }
    }
}

fn sort_triangles(vertices: &[Vertex], indices: &mut [u32]) {
    let corner = |index: u32| Vec3::from(vertices[index as usize].position);
    let (mut least, mut most) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &index in indices.iter() {
        least = least.min(corner(index));
        most = most.max(corner(index));
    }
    let scale = CELLS / (most - least).max_element().max(f32::MIN_POSITIVE);
    let mut triangles: Vec<[u32; 3]> = indices.as_chunks().0.to_vec();
    triangles.sort_by_cached_key(|triangle| {
        let middle = triangle.map(corner).iter().sum::<Vec3>() / 3.0;
        morton(((middle - least) * scale).min(Vec3::splat(CELLS - 1.0)).as_uvec3())
    });
    indices.copy_from_slice(triangles.as_flattened());
}

/// Morton code of three 10-bit numbers.
fn morton(cell: UVec3) -> u32 {
    let [x, y, z] = cell.to_array().map(|n| (0..10).map(|bit| (n >> bit & 1) << (3 * bit)).sum::<u32>());
    x | y << 1 | z << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sorted_triangles_are_the_same_ones_and_neighbours_follow_each_other() {
        let at = |x: f32| Vertex { position: [x, 0.0, 0.0], ..bytemuck::Zeroable::zeroed() };
        let vertices: Vec<Vertex> = (0..300).map(|i| at((i * 7 % 100) as f32 + (i % 3) as f32 * 0.1)).collect();
        let mut indices: Vec<u32> = (0..100).flat_map(|t| [0, 1, 2].map(|k| (t * 37 % 100) * 3 + k)).collect();
        let before: std::collections::BTreeSet<[u32; 3]> = indices.as_chunks().0.iter().copied().collect();
        sort_triangles(&vertices, &mut indices);
        assert_eq!(indices.as_chunks().0.iter().copied().collect::<std::collections::BTreeSet<[u32; 3]>>(), before);
        let middles: Vec<f32> =
            indices.as_chunks::<3>().0.iter().map(|t| t.iter().map(|&i| vertices[i as usize].position[0]).sum::<f32>()).collect();
        assert!(middles.windows(2).all(|pair| pair[0] <= pair[1] + 0.3), "{middles:?}");
    }

    #[test]
    fn a_mesh_without_extent_and_one_without_triangles_are_taken() {
        let vertices = [Vertex { position: [1.0; 3], ..bytemuck::Zeroable::zeroed() }];
        let mut indices = [0; 6];
        sort_triangles(&vertices, &mut indices);
        sort_triangles(&vertices, &mut []);
        assert_eq!(indices, [0; 6]);
    }
}
