//! Triangles of a scene, prepared for the points of imperfect shadow maps: positions without other attributes, chunks of one workgroup
//! each, and a histogram of areas. They are made once, from the scene at rest.

use crate::config::{Config, VisibilityMethod};
use crate::gpu::{BufferId, Gpu};
use crate::graph::{Buffer, DrawList, Graph};
use crate::scene::Scene;
use crate::shader_struct;
use crate::stages::sky;
use crate::world::device::{DrawArguments, FrameScene, VERTEX};
use anyhow::Result;
use rayon::prelude::*;

/// Whether a config renders imperfect shadow maps, and so needs points of the scene's triangles.
pub fn needs_triangles(config: &Config) -> bool {
    sky::needs_maps(config) || config.visibility_methods().any(|method| method == VisibilityMethod::ImperfectShadowMaps)
}

shader_struct! {
    /// Triangles of one draw for one workgroup: `glsl/visibility/points-computed.comp`.
    pub struct ChunkData {
        pub first_index: u32,
        pub triangles: u32,
        pub vertex_offset: u32,
        pub draw: u32,
        /// This workgroup's number among the `slices` that share the chunk's points.
        pub slice: u32,
        pub slices: u32,
    }
}

/// Triangles of a chunk, at most: the workgroup's size.
const CHUNK: u32 = 64;
/// Points that a workgroup makes, at most, roughly.
const POINTS_A_GROUP: f64 = 2048.0;

/// Prepared triangles of a scene. The device owns the buffers.
pub struct Triangles {
    positions: BufferId,
    vertex_count: u32,
    chunks: Vec<Chunk>,
    areas: Areas,
}

/// The part of a chunk that is the same in all frames.
struct Chunk {
    data: ChunkData,
    /// Area of all its triangles, and of the largest, m^2.
    area: f32,
    largest: f32,
}

/// The triangles in one frame's graph.
#[derive(Clone, Copy)]
pub struct FrameTriangles<'f> {
    pub table: &'f Triangles,
    /// Positions of the scene's vertices, in their draw's object space, metres.
    pub positions: Buffer,
}

impl Triangles {
    pub fn upload(gpu: &mut Gpu, scene: &Scene) -> Result<Self> {
        let positions: Vec<[f32; 3]> = scene.vertices.par_iter().map(|vertex| vertex.position).collect();
        let (mut chunks, mut areas) = (Vec::new(), Areas::default());
        for (number, draw) in scene.draws.iter().enumerate() {
            let corners: Vec<_> = scene.draw_vertices(draw).map(|v| draw.transform.transform_point3(v.position.into())).collect();
            for (i, triangles) in corners.chunks(3 * CHUNK as usize).enumerate() {
                let (mut sum, mut largest) = (0.0, 0.0f32);
                for t in triangles.chunks_exact(3) {
                    let area = 0.5 * (t[1] - t[0]).cross(t[2] - t[0]).length();
                    areas.add(area);
                    sum += area;
                    largest = largest.max(area);
                }
                let data = ChunkData {
                    first_index: draw.first_index + 3 * CHUNK * i as u32,
                    triangles: triangles.len() as u32 / 3,
                    vertex_offset: draw.vertex_offset,
                    draw: number as u32,
                    slice: 0,
                    slices: 1,
                };
                chunks.push(Chunk { data, area: sum, largest });
            }
        }
        Ok(Self {
            positions: gpu.create_filled_buffer("scene/positions", bytemuck::cast_slice(&positions))?,
            vertex_count: positions.len() as u32,
            chunks,
            areas,
        })
    }

    /// Imports the triangles into a frame's graph.
    pub fn import(&self, g: &mut Graph) -> FrameTriangles<'_> {
        FrameTriangles { table: self, positions: g.import_buffer::<[f32; 3]>("scene/positions", self.positions, self.vertex_count) }
    }

    /// All triangles as patches to tessellate, without materials and without culling.
    pub fn patch_list(&self, g: &mut Graph, scene: FrameScene<'_>, name: &str, max_area: f32) -> Vec<DrawList> {
        let patches = self.patches(max_area);
        if patches.is_empty() {
            return Vec::new();
        }
        let arguments = g.upload(name, &patches);
        vec![DrawList::new(VERTEX, [scene.vertices, scene.indices], arguments)]
    }

    /// Chunks for `max_area`, one element a workgroup; a chunk that gives many points is shared by several workgroups.
    pub fn chunks(&self, max_area: f32) -> Vec<ChunkData> {
        let slices = |chunk: &Chunk| {
            let points = f64::from(chunk.data.triangles) + 1.5 * f64::from(chunk.area) / f64::from(max_area);
            let slices = (points / POINTS_A_GROUP).ceil().clamp(1.0, 4096.0) as u32;
            let chunk = chunk.data;
            (0..slices).map(move |slice| ChunkData { slice, slices, ..chunk })
        };
        self.chunks.iter().flat_map(slices).collect()
    }

    /// Draw arguments of all triangles as patches, with an instance for each part that the chunk's largest triangle is split into.
    pub fn patches(&self, max_area: f32) -> Vec<DrawArguments> {
        let mut draws: Vec<DrawArguments> = Vec::new();
        for Chunk { data, largest, .. } in &self.chunks {
            // The device's rounding may make it one part more.
            let split = subdivision(f64::from(*largest) * 1.001, f64::from(max_area)).0 as u32;
            let arguments = DrawArguments {
                index_count: 3 * data.triangles,
                instance_count: split * split,
                first_index: data.first_index,
                vertex_offset: data.vertex_offset as i32,
                first_instance: data.draw,
            };
            match draws.last_mut() {
                Some(last)
                    if DrawArguments { index_count: 0, first_index: 0, ..*last }
                        == DrawArguments { index_count: 0, first_index: 0, ..arguments }
                        && last.first_index + last.index_count == arguments.first_index
                        && last.index_count < 3 * 4096 =>
                {
                    last.index_count += arguments.index_count;
                }
                _ => draws.push(arguments),
            }
        }
        draws
    }

    /// Largest area of a small triangle, m^2, that gives about `points` points; see `glsl/visibility/point.glsl`. A triangle gives at least
    /// one point unless small triangles are thinned.
    pub fn max_area(&self, points: u32, thin: bool) -> f32 {
        self.areas.max_area(f64::from(points), thin)
    }

    /// Points that `max_area` gives: the expected number if small triangles are thinned, else an upper bound.
    pub fn points(&self, max_area: f32, thin: bool) -> f64 {
        self.areas.points(max_area, thin)
    }
}

/// Histogram of triangle areas, binned by logarithm.
#[derive(Debug, Clone)]
struct Areas {
    bins: Vec<Bin>,
}

/// Triangles of about the same area.
#[derive(Debug, Clone, Default)]
struct Bin {
    count: f64,
    sum: f64,
    largest: f64,
}

impl Default for Areas {
    fn default() -> Self {
        Self { bins: vec![Bin::default(); Self::BINS] }
    }
}

impl Areas {
    const BINS: usize = 4096;
    const PER_OCTAVE: f32 = 48.0;
    /// Relative rounding error of an area on the device.
    const ROUNDING: f64 = 1e-5;

    fn total(&self) -> f64 {
        self.bins.iter().map(|bin| bin.sum).sum()
    }

    fn add(&mut self, area: f32) {
        if area > 0.0 {
            let bin = (area.log2() * Self::PER_OCTAVE) as i64 + Self::BINS as i64 / 2;
            let bin = &mut self.bins[bin.clamp(0, Self::BINS as i64 - 1) as usize];
            bin.count += 1.0;
            bin.sum += f64::from(area);
            bin.largest = bin.largest.max(f64::from(area));
        }
    }

    fn points(&self, max_area: f32, thin: bool) -> f64 {
        let max_area = f64::from(max_area);
        if thin {
            return self.total() / max_area;
        }
        // Bounded by the largest area of each bin, plus the device's rounding. A mesh of equal triangles may lie just where the next
        // tessellation level begins, and would otherwise give more points than there is room for.
        let some = self.bins.iter().filter(|bin| bin.count > 0.0);
        some.map(|bin| bin.count * points_of_triangle(bin.largest * (1.0 + Self::ROUNDING), max_area)).sum()
    }

    fn max_area(&self, points: f64, thin: bool) -> f32 {
        let total = self.total();
        if thin {
            return (total / points) as f32;
        }
        // The number of points falls as the area of one rises.
        let (mut low, mut high) = (total.max(1e-30).ln() - 40.0, total.max(1e-30).ln() + 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.points(middle.exp() as f32, thin) > points { low = middle } else { high = middle }
        }
        high.exp() as f32
    }
}

/// Points of a triangle, by `subdivision` of `glsl/visibility/point.glsl`.
fn points_of_triangle(area: f64, max_area: f64) -> f64 {
    let (split, n) = subdivision(area, max_area);
    split * split * (1.5 * n * n).floor()
}

/// Parts that a side of a triangle is cut into, and the tessellation level of each part: `glsl/visibility/point.glsl`.
fn subdivision(area: f64, max_area: f64) -> (f64, f64) {
    let level = |area: f64| if area <= max_area { 1.0 } else { (area * (2.0 / 3.0) / max_area).sqrt().ceil().max(2.0) };
    let split = (level(area) / MOST_LEVEL).ceil();
    (split, level(area / (split * split)).min(MOST_LEVEL))
}

/// Highest tessellation level at which no driver loses patches: `MOST_LEVEL` of `glsl/visibility/point.glsl`.
const MOST_LEVEL: f64 = 15.0;
