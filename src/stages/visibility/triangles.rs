//! Triangles of a scene as the points of imperfect shadow maps are made from them: positions by themselves, chunks that a workgroup
//! takes, and areas. They are made once, of the scene at rest.

use crate::gpu::{BufferId, Gpu};
use crate::graph::{Buffer, DrawList, Graph};
use crate::scene::Scene;
use crate::shader_struct;
use crate::world::device::{DrawArguments, FrameScene, VERTEX};
use anyhow::Result;
use rayon::prelude::*;

shader_struct! {
    /// Triangles of one draw for one workgroup: `glsl/visibility/points-computed.comp`.
    pub struct ChunkData {
        pub first_index: u32,
        pub triangles: u32,
        pub vertex_offset: u32,
        pub draw: u32,
        /// Of `slices` workgroups that share the chunk's points out.
        pub slice: u32,
        pub slices: u32,
    }
}

/// Triangles of a chunk at most: the workgroup's size.
const CHUNK: u32 = 64;
/// Points that a workgroup should make at most, roughly.
const POINTS_A_GROUP: f64 = 2048.0;

/// See the module's page. The device owns the buffers.
pub struct Triangles {
    positions: BufferId,
    vertex_count: u32,
    chunks: Vec<Chunk>,
    areas: Areas,
}

/// What is the same in all frames of a chunk.
struct Chunk {
    data: ChunkData,
    /// Of all its triangles, and of the largest, m^2.
    area: f32,
    largest: f32,
}

/// The triangles in one frame's graph.
#[derive(Clone, Copy)]
pub struct FrameTriangles<'f> {
    pub table: &'f Triangles,
    /// Of the scene's vertices, each in its draw's own space, metres.
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

    /// The triangles as this frame's resources.
    pub fn import(&self, g: &mut Graph) -> FrameTriangles<'_> {
        FrameTriangles { table: self, positions: g.import_buffer::<[f32; 3]>("scene/positions", self.positions, self.vertex_count) }
    }

    /// All triangles as patches to tessellate, whatever any view sees, without their materials.
    pub fn patch_list(&self, g: &mut Graph, scene: FrameScene<'_>, name: &str, max_area: f32) -> Vec<DrawList> {
        let patches = self.patches(max_area);
        if patches.is_empty() {
            return Vec::new();
        }
        let arguments = g.upload(name, &patches);
        vec![DrawList {
            textures: Vec::new(),
            blocks: Vec::new(),
            constants: Vec::new(),
            cull_back: false,
            vertex: VERTEX,
            vertices: scene.vertices,
            indices: scene.indices,
            arguments,
            first: 0,
            count: patches.len() as u32,
        }]
    }

    /// A workgroup an element: chunks of which `max_area` makes many points go to several.
    pub fn chunks(&self, max_area: f32) -> Vec<ChunkData> {
        let slices = |chunk: &Chunk| {
            let points = f64::from(chunk.data.triangles) + 1.5 * f64::from(chunk.area) / f64::from(max_area);
            let slices = (points / POINTS_A_GROUP).ceil().clamp(1.0, 4096.0) as u32;
            let chunk = chunk.data;
            (0..slices).map(move |slice| ChunkData { slice, slices, ..chunk })
        };
        self.chunks.iter().flat_map(slices).collect()
    }

    /// Draws of all triangles as patches: an instance for each part that the chunk's largest triangle is split into.
    pub fn patches(&self, max_area: f32) -> Vec<DrawArguments> {
        let mut draws: Vec<DrawArguments> = Vec::new();
        for Chunk { data, largest, .. } in &self.chunks {
            // What the device's rounding may make of it is a part more at most.
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

    /// The largest small triangle's area, m^2, that gives about so many points; see `glsl/visibility/point.glsl`. Every triangle gives
    /// at least one unless small ones are thinned.
    pub fn max_area(&self, points: u32, thin: bool) -> f32 {
        self.areas.max_area(f64::from(points), thin)
    }

    /// How many points that area gives: on the average where small triangles are thinned, else at most.
    pub fn points(&self, max_area: f32, thin: bool) -> f64 {
        self.areas.points(max_area, thin)
    }
}

/// How many triangles there are of each size: bins of the area's logarithm.
#[derive(Debug, Clone)]
struct Areas {
    bins: Vec<Bin>,
}

/// Triangles of about the same size.
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
    /// Of an area, relative.
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
        // By the largest of each bin, and what the device may round it to: else a mesh of equal triangles, whose area may lie right
        // where the next level begins, would give more points than there is room for.
        let some = self.bins.iter().filter(|bin| bin.count > 0.0);
        some.map(|bin| bin.count * points_of_triangle(bin.largest * (1.0 + Self::ROUNDING), max_area)).sum()
    }

    fn max_area(&self, points: f64, thin: bool) -> f32 {
        let total = self.total();
        if thin {
            return (total / points) as f32;
        }
        // The more area a point stands for, the fewer there are.
        let (mut low, mut high) = (total.max(1e-30).ln() - 40.0, total.max(1e-30).ln() + 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.points(middle.exp() as f32, thin) > points { low = middle } else { high = middle }
        }
        high.exp() as f32
    }
}

/// Points of a triangle, as `subdivision` of `glsl/visibility/point.glsl` gives them.
fn points_of_triangle(area: f64, max_area: f64) -> f64 {
    let (split, n) = subdivision(area, max_area);
    split * split * (1.5 * n * n).floor()
}

/// Into how many parts a side of a triangle is cut, and the level that those are tessellated with: `glsl/visibility/point.glsl`.
fn subdivision(area: f64, max_area: f64) -> (f64, f64) {
    let level = |area: f64| if area <= max_area { 1.0 } else { (area * (2.0 / 3.0) / max_area).sqrt().ceil().max(2.0) };
    let split = (level(area) / MOST_LEVEL).ceil();
    (split, level(area / (split * split)).min(MOST_LEVEL))
}

/// The tessellation level that no driver loses patches with, of `glsl/visibility/point.glsl`.
const MOST_LEVEL: f64 = 15.0;
