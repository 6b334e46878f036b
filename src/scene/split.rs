//! Splitting of triangles with long edges: projections that bend edges, such as the paraboloid one, bend short ones little.

use super::pack::{octahedral_snorm16, octahedral_snorm16_inverse, tangent, tangent_inverse, unorm8x4};
use super::{Scene, Vertex};
use glam::{Affine3A, Vec2, Vec3, Vec4};
use std::collections::{BTreeMap, HashMap};

impl Scene {
    /// Splits triangles until no edge is longer than `part` (over 0) of the scene's diagonal. Edges are halved. Whether an edge
    /// is split depends on it alone, so that neighbours stay neighbours. Meshes that bend are not split.
    pub fn split_triangles(&mut self, part: f32) {
        let longest = part * self.bounds().size().length();
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
    use crate::scene::Draw;

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
        assert!(scene.vertices.iter().skip(1).all(|v| v.uv == [v.position[0], v.position[2]] && v.color == u32::MAX));
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
            let [x, _, z] = scene.vertices[(i + 1) as usize].position;
            x == 0.0 || x == 8.0 || z == 0.0 || z == 3.0
        };
        assert!(edges.iter().all(|([a, b], sum)| *sum == 0 || (outside(*a) && outside(*b))));
    }

    #[test]
    fn short_edges_stay() {
        let mut scene = scene();
        let before = scene.indices.clone();
        scene.split_triangles(1.0);
        assert_eq!(scene.indices, before);
    }
}
