//! Splitting of triangles with long edges: projections that bend edges, such as the paraboloid one, bend short ones little.

use super::pack::{octahedral_snorm16, octahedral_snorm16_inverse, tangent, tangent_inverse, unorm8x4};
use super::{Draw, Scene, Vertex};
use glam::{Affine3A, Vec2, Vec3, Vec4};
use std::collections::{BTreeMap, BTreeSet, HashMap};

impl Scene {
    /// Splits triangles until no edge is longer than `part` (over 0) of the scene's diagonal. Edges are halved. Whether an edge
    /// is split depends on it alone, so that neighbours stay neighbours. Meshes that bend are not split.
    pub fn split_triangles(&mut self, part: f32) {
        let longest = part * self.bounds().size().length();
        let before = self.vertices.len();
        assert!(part > 0.0, "edges cannot be shorter than nothing");
        let mut ranges: BTreeMap<(u32, u32, u32), Vec<Affine3A>> = BTreeMap::new();
        for draw in &self.draws {
            ranges.entry((draw.first_index, draw.index_count, draw.vertex_offset)).or_default().push(draw.transform);
        }
        let mut indices = Vec::with_capacity(self.indices.len());
        let mut moved = HashMap::new();
        for (range, transforms) in ranges {
            let (first, count, offset) = range;
            let triangles = &self.indices[first as usize..(first + count) as usize];
            let begin = indices.len() as u32;
            match &self.bending {
                Some(bending) if bending.has(offset) => indices.extend(triangles),
                _ => split(&mut self.vertices, offset, triangles, &transforms, longest, &mut indices),
            }
            moved.insert(range, (begin, indices.len() as u32 - begin));
        }
        self.indices = indices;
        for draw in &mut self.draws {
            (draw.first_index, draw.index_count) = moved[&(draw.first_index, draw.index_count, draw.vertex_offset)];
        }
        self.lay_side_by_side(before);
    }

    /// Length of the longest edge of a triangle that [`Self::split_triangles`] would split, metres.
    pub fn longest_edge(&self) -> f32 {
        let splits = |draw: &&Draw| !self.bending.as_ref().is_some_and(|bending| bending.has(draw.vertex_offset));
        let of_draw = |draw: &Draw| {
            let corners: Vec<Vec3> =
                self.draw_vertices(draw).map(|vertex| draw.transform.transform_point3(vertex.position.into())).collect();
            let longest = |[a, b, c]: &[Vec3; 3]| a.distance_squared(*b).max(b.distance_squared(*c)).max(c.distance_squared(*a));
            corners.as_chunks().0.iter().map(longest).fold(0.0, f32::max)
        };
        self.draws.iter().filter(splits).map(of_draw).fold(0.0, f32::max).sqrt()
    }

    /// Lays the vertices of each mesh side by side, also those that splitting has put behind the `before` first ones, and leaves out those
    /// that no triangle has. So a mesh's vertices span as many as there are. Meshes that bend keep their place, by which they are known.
    fn lay_side_by_side(&mut self, before: usize) {
        let bends = |draw: &Draw| self.bending.as_ref().is_some_and(|bending| bending.has(draw.vertex_offset));
        let still = self.draws.iter().filter(|draw| !bends(draw));
        let ranges: BTreeSet<(u32, u32, u32)> = still.map(|draw| (draw.vertex_offset, draw.first_index, draw.index_count)).collect();
        let ranges: Vec<_> = ranges.into_iter().collect();
        let mut vertices = if self.bending.is_some() { self.vertices[..before].to_vec() } else { Vec::new() };
        let mut moved = HashMap::new();
        for mesh in ranges.chunk_by(|a, b| a.0 == b.0) {
            let offset = mesh[0].0;
            let places = || mesh.iter().map(|(_, first, count)| *first as usize..(*first + *count) as usize);
            let mut used: Vec<u32> = places().flat_map(|range| self.indices[range].iter().copied()).collect();
            used.sort_unstable();
            used.dedup();
            moved.insert(offset, vertices.len() as u32);
            vertices.extend(used.iter().map(|index| self.vertices[(offset + index) as usize]));
            for index in places().flat_map(|range| range.collect::<Vec<_>>()) {
                let place = used.binary_search(&self.indices[index]);
                self.indices[index] = place.expect("the mesh's indices are among those used") as u32;
            }
        }
        self.vertices = vertices;
        for draw in &mut self.draws {
            draw.vertex_offset = moved.get(&draw.vertex_offset).copied().unwrap_or(draw.vertex_offset);
        }
    }
}

fn split(vertices: &mut Vec<Vertex>, offset: u32, triangles: &[u32], transforms: &[Affine3A], longest: f32, out: &mut Vec<u32>) {
    let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
    let mut open: Vec<[u32; 3]> = triangles.as_chunks().0.iter().rev().copied().collect();
    while let Some(triangle) = open.pop() {
        let corners = triangle.map(|i| Vec3::from(vertices[(offset + i) as usize].position));
        // Edge k is between corners k and k + 1.
        let long = [0, 1, 2].map(|k| {
            let edge = corners[(k + 1) % 3] - corners[k];
            transforms.iter().any(|transform| transform.transform_vector3(edge).length() > longest)
        });
        if long == [false; 3] {
            out.extend(triangle);
            continue;
        }
        let mut middle = |k: usize| {
            let [a, b] = [triangle[k], triangle[(k + 1) % 3]];
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                let halved = halfway(&vertices[(offset + a.min(b)) as usize], &vertices[(offset + a.max(b)) as usize]);
                vertices.push(halved);
                vertices.len() as u32 - 1 - offset
            })
        };
        match long.iter().filter(|is_long| **is_long).count() {
            3 => {
                let m = [middle(0), middle(1), middle(2)];
                open.extend([[triangle[0], m[0], m[2]], [m[0], triangle[1], m[1]], [m[2], m[1], triangle[2]], m]);
            }
            2 => {
                // Corners are rotated so that the short edge is last.
                let k = (long.iter().position(|is_long| !is_long).unwrap_or(0) + 1) % 3;
                let [a, b, c] = [0, 1, 2].map(|i| triangle[(k + i) % 3]);
                let (ab, bc) = (middle(k), middle((k + 1) % 3));
                open.extend([[ab, b, bc], [a, ab, bc], [a, bc, c]]);
            }
            _ => {
                let k = long.iter().position(|is_long| *is_long).unwrap_or(0);
                let [a, b, c] = [0, 1, 2].map(|i| triangle[(k + i) % 3]);
                let ab = middle(k);
                open.extend([[a, ab, c], [ab, b, c]]);
            }
        }
    }
}

/// The vertex halfway between two.
fn halfway(a: &Vertex, b: &Vertex) -> Vertex {
    let unit = |a: Vec3, b: Vec3| (a + b).try_normalize().unwrap_or(a);
    let color = |packed: u32| Vec4::from_array(packed.to_le_bytes().map(|c| f32::from(c) / 255.0));
    let ((along_a, handedness), (along_b, _)) = (tangent_inverse(a.tangent), tangent_inverse(b.tangent));
    Vertex {
        position: (0.5 * (Vec3::from(a.position) + Vec3::from(b.position))).into(),
        normal: octahedral_snorm16(unit(octahedral_snorm16_inverse(a.normal), octahedral_snorm16_inverse(b.normal))),
        uv: (0.5 * (Vec2::from(a.uv) + Vec2::from(b.uv))).into(),
        color: unorm8x4((0.5 * (color(a.color) + color(b.color))).into()),
        tangent: tangent(unit(along_a, along_b), handedness),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vertex(position: Vec3) -> Vertex {
        Vertex { position: position.into(), normal: octahedral_snorm16(Vec3::Y), color: u32::MAX, uv: [position.x, position.z], tangent: 0 }
    }

    /// A strip of two large triangles, drawn twice, the second time at twice the size.
    fn scene() -> Scene {
        let corners = [Vec3::ZERO, Vec3::new(0.0, 0.0, 3.0), Vec3::new(8.0, 0.0, 0.0), Vec3::new(8.0, 0.0, 3.0)];
        let draw = |scale| Draw {
            first_index: 0,
            index_count: 6,
            vertex_offset: 1,
            material: 0,
            transform: Affine3A::from_scale(Vec3::splat(scale)),
        };
        Scene {
            vertices: std::iter::once(vertex(Vec3::ONE)).chain(corners.map(vertex)).collect(),
            indices: vec![0, 1, 2, 2, 1, 3],
            draws: vec![draw(1.0), draw(2.0)],
            ..Scene::default()
        }
    }

    #[test]
    fn no_edge_is_longer_than_asked_and_the_surface_is_the_same() {
        let mut scene = scene();
        let longest = 0.05 * scene.bounds().size().length();
        scene.split_triangles(0.05);
        assert_eq!(scene.draws[0].index_count, scene.indices.len() as u32);
        assert!(scene.longest_edge() <= longest * 1.0001 && scene.longest_edge() > 0.5 * longest);
        for draw in &scene.draws {
            let corners: Vec<Vec3> =
                scene.draw_vertices(draw).map(|vertex| draw.transform.transform_point3(vertex.position.into())).collect();
            let mut area = 0.0;
            for [a, b, c] in corners.as_chunks().0 {
                assert!([a.distance(*b), b.distance(*c), c.distance(*a)].into_iter().all(|edge| edge <= longest * 1.0001));
                let across = (b - a).cross(c - a);
                assert!(across.y > 0.0, "the triangle has been turned over");
                area += 0.5 * across.length();
            }
            let scale = draw.transform.matrix3.x_axis.x;
            assert!((area - 24.0 * scale * scale).abs() < 1e-3, "{area}");
        }
        assert!(scene.vertices.iter().all(|v| v.uv == [v.position[0], v.position[2]] && v.color == u32::MAX));
    }

    #[test]
    fn neighbours_share_the_vertices_of_their_edge() {
        let mut scene = scene();
        scene.split_triangles(0.05);
        // Every inner edge occurs once in each direction; an edge of the strip's border occurs once.
        let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
        for [a, b, c] in scene.indices.as_chunks().0 {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *edges.entry([*from.min(to), *from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            }
        }
        let outside = |i: u32| {
            let [x, _, z] = scene.vertices[(scene.draws[0].vertex_offset + i) as usize].position;
            x == 0.0 || x == 8.0 || z == 0.0 || z == 3.0
        };
        assert!(edges.iter().all(|([a, b], sum)| *sum == 0 || (outside(*a) && outside(*b))));
    }

    #[test]
    fn vertices_of_a_mesh_lie_side_by_side() {
        let mut scene = scene();
        // A second mesh, of two draws that share vertices, behind the first.
        let (first, offset) = (scene.indices.len() as u32, scene.vertices.len() as u32);
        scene.vertices.extend([Vec3::ZERO, Vec3::Z, Vec3::X, Vec3::new(1.0, 0.0, 1.0)].map(vertex));
        scene.indices.extend([0, 1, 2, 2, 1, 3]);
        let draw = |first_index| Draw { first_index, index_count: 3, vertex_offset: offset, material: 0, transform: Affine3A::IDENTITY };
        scene.draws.extend([draw(first), draw(first + 3)]);
        let corners = |scene: &Scene| -> Vec<[f32; 3]> {
            scene.draws[2..].iter().flat_map(|draw| scene.draw_vertices(draw).map(|vertex| vertex.position)).collect()
        };
        let before = corners(&scene);
        scene.split_triangles(0.1);
        let span = |draws: &[Draw]| {
            let of_draw = |draw: &Draw| {
                let indices = &scene.indices[draw.first_index as usize..(draw.first_index + draw.index_count) as usize];
                indices.iter().map(|index| draw.vertex_offset + index).collect::<Vec<_>>()
            };
            let used: BTreeSet<u32> = draws.iter().flat_map(of_draw).collect();
            assert_eq!(used.last().unwrap() - used.first().unwrap() + 1, used.len() as u32, "vertices lie between that others have");
            *used.first().unwrap()..used.last().unwrap() + 1
        };
        let (strip, square) = (span(&scene.draws[..2]), span(&scene.draws[2..]));
        assert!(strip.end == square.start && square.end as usize == scene.vertices.len(), "{strip:?}, {square:?}");
        assert_eq!(corners(&scene), before, "short edges stay");
    }

    #[test]
    fn short_edges_stay() {
        let mut scene = scene();
        let before = scene.indices.clone();
        scene.split_triangles(1.0);
        assert_eq!(scene.indices, before);
    }
}
