//! Hulls of the unit sphere: an icosahedron around it, and one with its faces cut in four.

use crate::config::{Config, StochasticCulling};
use crate::gpu::{BufferId, Feature, Gpu};
use crate::graph::{Buffer, DrawList, Graph};
use crate::scene::{Vertex, pack};
use crate::world::device::{DrawArguments, VERTEX};
use anyhow::Result;
use glam::Vec3;
use std::collections::BTreeMap;

/// Features for conservative rasterization by the device.
pub const CONSERVATIVE: &[Feature] = &[Feature::ConservativeRasterization, Feature::ClipDistance];

/// Whether a config's gather rasterizes hulls of ranges.
pub fn needs_shells(config: &Config) -> bool {
    matches!(config.gather.stochastic_culling(), Some(StochasticCulling::Splatting | StochasticCulling::ConservativeClusters))
}

/// Hulls, by their number of triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shell {
    /// Twenty, unindexed: a shader finds all three corners of a vertex's triangle by `gl_VertexIndex` in [`Shells::corners`].
    Corners,
    Twenty,
    Eighty,
}

/// Hulls on the device; they are made once.
pub struct Shells {
    vertices: (BufferId, u32),
    indices: (BufferId, u32),
    /// First index, number of indices and first vertex of each hull.
    ranges: [[u32; 3]; 3],
    corners: Vec<[f32; 3]>,
    /// Whether the device rasterizes conservatively by itself.
    pub conservative: bool,
}

impl Shells {
    pub fn upload(gpu: &mut Gpu) -> Result<Self> {
        let (mut vertices, mut indices, mut ranges) = (Vec::new(), Vec::<u32>::new(), [[0; 3]; 3]);
        let (points, triangles) = around_the_sphere(icosahedron());
        let corners: Vec<Vec3> = triangles.iter().flatten().map(|i| points[*i as usize]).collect();
        let apart = (0..20).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        // Corners begin at vertex 0.
        let solids = [(corners.clone(), apart), (points, triangles), around_the_sphere(divided(&icosahedron()))];
        for (range, (points, triangles)) in ranges.iter_mut().zip(solids) {
            *range = [indices.len() as u32, 3 * triangles.len() as u32, vertices.len() as u32];
            // Counter-clockwise from outside. View space is left-handed, so culling back faces there keeps the far sides.
            indices.extend(triangles.iter().flatten());
            vertices.extend(points.iter().map(|p| Vertex {
                position: (*p).into(),
                normal: pack::octahedral_snorm16(p.normalize()),
                uv: [0.0; 2],
                color: u32::MAX,
                tangent: 0,
            }));
        }
        Ok(Self {
            vertices: (gpu.create_filled_buffer("shells/vertices", bytemuck::cast_slice(&vertices))?, vertices.len() as u32),
            indices: (gpu.create_filled_buffer("shells/indices", bytemuck::cast_slice(&indices))?, indices.len() as u32),
            ranges,
            corners: corners.into_iter().map(Into::into).collect(),
            conservative: gpu.adapter.missing(CONSERVATIVE).is_empty(),
        })
    }

    /// Imports the hulls into a frame's graph.
    pub fn import(&self, g: &mut Graph) -> FrameShells<'_> {
        FrameShells {
            shells: self,
            vertices: g.import_buffer::<Vertex>("shells/vertices", self.vertices.0, self.vertices.1),
            indices: g.import_buffer::<u32>("shells/indices", self.indices.0, self.indices.1),
        }
    }
}

/// The shells in one frame's graph.
#[derive(Clone, Copy)]
pub struct FrameShells<'f> {
    shells: &'f Shells,
    vertices: Buffer,
    indices: Buffer,
}

impl FrameShells<'_> {
    /// Whether the device rasterizes conservatively by itself.
    pub fn conservative(&self) -> bool {
        self.shells.conservative
    }

    /// Corners of [`Shell::Corners`]: three a triangle.
    pub fn corners(&self, g: &mut Graph, name: &str) -> Buffer {
        g.upload(name, &self.shells.corners)
    }

    /// Draw list of `instances` instances of a hull, with these specialization constants; `far_sides` culls the near sides.
    pub fn list(
        &self,
        g: &mut Graph,
        name: &str,
        shell: Shell,
        instances: u32,
        far_sides: bool,
        constants: Vec<(&'static str, u32)>,
    ) -> DrawList {
        let [first_index, index_count, first_vertex] = self.shells.ranges[shell as usize];
        let arguments =
            DrawArguments { index_count, instance_count: instances, first_index, vertex_offset: first_vertex as i32, first_instance: 0 };
        let list = DrawList::new(VERTEX, [self.vertices, self.indices], g.upload(name, &[arguments]));
        DrawList { constants, cull_back: far_sides, ..list }
    }
}

type Solid = (Vec<Vec3>, Vec<[u32; 3]>);

/// Corners on the unit sphere; triangles counter-clockwise from outside.
fn icosahedron() -> Solid {
    let golden = 0.5 * (1.0 + 5f32.sqrt());
    let mut points = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        points.extend([Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)].map(Vec3::normalize));
    }
    // Three corners form a face if each two are an edge's length apart.
    let edge = 2.0 / (1.0 + golden * golden).sqrt() + 1e-3;
    let near = |i: usize, j: usize| points[i].distance(points[j]) < edge;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    let outward = (points[b] - points[a]).cross(points[c] - points[a]).dot(points[a]) > 0.0;
                    let [b, c] = if outward { [b, c] } else { [c, b] };
                    triangles.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    (points, triangles)
}

/// Each triangle cut in four, with the new corners on the sphere.
fn divided((points, triangles): &Solid) -> Solid {
    let mut all = points.clone();
    let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    let mut fine = Vec::new();
    for [a, b, c] in triangles.iter().copied() {
        let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|[i, j]| {
            *middles.entry([i.min(j), i.max(j)]).or_insert_with(|| {
                all.push((points[i as usize] + points[j as usize]).normalize());
                all.len() as u32 - 1
            })
        });
        fine.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    (all, fine)
}

/// Hull scaled until no face cuts into the sphere, and by 2.4 % more for the rounding of narrow lobes.
fn around_the_sphere((points, triangles): Solid) -> Solid {
    let nearest = triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| points[i as usize]);
            (b - a).cross(c - a).normalize().dot(a)
        })
        .fold(1.0, f32::min);
    (points.iter().map(|p| *p / nearest * 1.024).collect(), triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shells_are_closed_around_the_unit_sphere_and_face_outwards() {
        for ((points, triangles), count) in [(icosahedron(), 20), (divided(&icosahedron()), 80)] {
            assert_eq!((triangles.len(), points.len()), (count, count / 2 + 2));
            let (points, triangles) = around_the_sphere((points, triangles));
            let mut volume = 0.0;
            for t in &triangles {
                let [a, b, c] = t.map(|i| points[i as usize]);
                let normal = (b - a).cross(c - a).normalize();
                assert!(normal.dot(a) >= 1.0, "a face cuts into the sphere by {}", 1.0 - normal.dot(a));
                volume += a.dot(b.cross(c)) / 6.0;
            }
            assert!(volume > 4.0 / 3.0 * std::f32::consts::PI && volume < 7.0, "a volume of {volume}");
        }
    }
}
