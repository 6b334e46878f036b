//! Triangles of a scene, prepared for the points of imperfect shadow maps: positions without other attributes, chunks of one workgroup
//! each, and a histogram of areas. They are made once, with every triangle as large as it ever is ([`Poses`]).

use super::areas::{Areas, subdivision};
use super::poses::Poses;
use crate::config::{Config, VisibilityMethod};
use crate::fail;
use crate::gpu::{BufferId, Gpu};
use crate::graph::{Buffer, Graph};
use crate::scene::Scene;
use crate::shader_struct;
use crate::stages::sky;
use crate::world::device::DrawArguments;
use anyhow::Result;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Whether a config renders imperfect shadow maps, and so needs points of the scene's triangles.
pub fn needs_triangles(config: &Config) -> bool {
    !thinnings(config).is_empty()
}

/// Values of `thin` that a config's imperfect shadow maps draw points with: those of the sky have points of equal area.
pub fn thinnings(config: &Config) -> BTreeSet<bool> {
    let of_vpls = config.visibility_methods().any(|method| method == VisibilityMethod::ImperfectShadowMaps);
    let of_sky = sky::needs_maps(config).then_some(true);
    of_vpls.then_some(config.visibility.ism.thin).into_iter().chain(of_sky).collect()
}

shader_struct! {
    /// Triangles of one draw for one workgroup: `glsl/visibility/chunk.glsl`.
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
/// Triangles drawn with one number of instances, at most, and where that number changes with time.
const MOST_DRAWN: u32 = 4096;
const MOST_DRAWN_GROWING: u32 = 1024;

/// Prepared triangles of a scene. The device owns the buffers.
pub struct Triangles {
    positions: BufferId,
    vertex_count: u32,
    /// Whether meshes bend, so that `deform::vertices` writes positions.
    bends: bool,
    chunks: Vec<Chunk>,
    areas: Areas,
    /// Whether the area of any triangle changes with time.
    pub grows: bool,
    /// Bytes of a buffer of points, at most: 128 MiB, and less where the device lets shaders see less.
    pub most_bytes: u64,
}

/// The part of a chunk that is the same in all frames.
struct Chunk {
    data: ChunkData,
    /// Area of all its triangles, and of the largest, m^2.
    area: f32,
    largest: f32,
    /// Whether its material has an alpha mask.
    masked: bool,
}

/// The triangles in one frame's graph.
#[derive(Clone, Copy)]
pub struct FrameTriangles<'f> {
    pub table: &'f Triangles,
    /// Positions of the scene's vertices, in their draw's object space, metres; those of meshes that bend are bent.
    pub positions: Buffer,
}

/// Patches that are drawn with one number of instances.
pub struct Patches {
    pub arguments: DrawArguments,
    /// The chunks that they are.
    pub first_chunk: u32,
    pub chunks: u32,
    /// Whether their material has an alpha mask.
    pub masked: bool,
}

impl Triangles {
    /// Prepares the triangles of a scene, which stands at second 0 of its animation.
    ///
    /// # Errors
    /// `BadInput` if the vertices or indices are more than shaders can see; the device's own, when memory runs out.
    pub fn upload(gpu: &mut Gpu, scene: &Scene) -> Result<Self> {
        let limit = gpu.adapter.limits.storage_buffer_bytes;
        let bytes = (12 * scene.vertices.len() as u64).max(4 * scene.indices.len() as u64);
        if bytes > limit {
            return Err(fail!(
                BadInput,
                "{}: points of its {} triangles need {} MB in a buffer, over the {} MB that {} lets a shader see; take another visibility.method or lower scene.triangles",
                scene.name,
                scene.triangle_count(),
                bytes >> 20,
                limit >> 20,
                gpu.adapter.name
            ));
        }
        let positions: Vec<[f32; 3]> = scene.vertices.par_iter().map(|vertex| vertex.position).collect();
        let poses = Poses::of(scene);
        let (mut chunks, mut areas) = (Vec::new(), Areas::default());
        for (number, draw) in scene.draws.iter().enumerate() {
            let masked = scene.materials[draw.material as usize].alpha_cutoff.is_some();
            for (i, triangles) in poses.areas(scene, number).chunks(CHUNK as usize).enumerate() {
                triangles.iter().for_each(|area| areas.add(*area));
                let data = ChunkData {
                    first_index: draw.first_index + 3 * CHUNK * i as u32,
                    triangles: triangles.len() as u32,
                    vertex_offset: draw.vertex_offset,
                    draw: number as u32,
                    slice: 0,
                    slices: 1,
                };
                let largest = triangles.iter().copied().fold(0.0, f32::max);
                chunks.push(Chunk { data, area: triangles.iter().sum(), largest, masked });
            }
        }
        chunks.sort_by_key(|chunk| chunk.masked);
        Ok(Self {
            positions: gpu.create_filled_buffer("scene/positions", bytemuck::cast_slice(&positions))?,
            vertex_count: positions.len() as u32,
            bends: scene.bending.is_some(),
            chunks,
            areas,
            grows: poses.grows,
            most_bytes: limit.min(128 << 20),
        })
    }

    /// Imports the triangles into a frame's graph.
    pub fn import(&self, g: &mut Graph) -> FrameTriangles<'_> {
        let (id, count) = (self.positions, self.vertex_count);
        let positions = match self.bends {
            true => g.keep_buffer::<[f32; 3]>("scene/positions", id, count),
            false => g.import_buffer::<[f32; 3]>("scene/positions", id, count),
        };
        FrameTriangles { table: self, positions }
    }

    /// Chunks for `max_area`, one element a workgroup; a chunk that gives many points is shared by several workgroups. Chunks with masks come
    /// last, and the number of the others' elements is returned too.
    pub fn chunks(&self, max_area: f32) -> (Vec<ChunkData>, usize) {
        let slices = |chunk: &Chunk| {
            let points = f64::from(chunk.data.triangles) + 1.5 * f64::from(chunk.area) / f64::from(max_area);
            let slices = (points / POINTS_A_GROUP).ceil().clamp(1.0, 4096.0) as u32;
            let chunk = chunk.data;
            (0..slices).map(move |slice| ChunkData { slice, slices, ..chunk })
        };
        let (whole, masked) = self.chunks.split_at(self.chunks.partition_point(|chunk| !chunk.masked));
        let mut all: Vec<ChunkData> = whole.iter().flat_map(slices).collect();
        let count = all.len();
        all.extend(masked.iter().flat_map(slices));
        (all, count)
    }

    /// All chunks, one element each.
    pub fn whole_chunks(&self) -> Vec<ChunkData> {
        self.chunks.iter().map(|chunk| chunk.data).collect()
    }

    /// All triangles as patches, with an instance for each part that the largest of them is split into. Where areas change, the instances
    /// are those of the largest areas, and draws are smaller, so that few patches stand by for the parts of another. Masked ones come last.
    pub fn patches(&self, max_area: f32) -> Vec<Patches> {
        let most = if self.grows { MOST_DRAWN_GROWING } else { MOST_DRAWN };
        let mut draws: Vec<Patches> = Vec::new();
        for (i, Chunk { data, largest, masked, .. }) in self.chunks.iter().enumerate() {
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
                Some(Patches { arguments: last, chunks, .. })
                    if DrawArguments { index_count: 0, first_index: 0, ..*last }
                        == DrawArguments { index_count: 0, first_index: 0, ..arguments }
                        && last.first_index + last.index_count == arguments.first_index
                        && last.index_count < 3 * most =>
                {
                    last.index_count += arguments.index_count;
                    *chunks += 1;
                }
                _ => draws.push(Patches { arguments, first_chunk: i as u32, chunks: 1, masked: *masked }),
            }
        }
        draws
    }

    /// Largest area of a small triangle, m^2, that gives about `points` points; see `glsl/visibility/point.glsl`. A triangle gives at least
    /// one point unless small triangles are thinned.
    pub fn max_area(&self, points: u32, thin: bool) -> f32 {
        self.areas.max_area(f64::from(points), thin)
    }

    /// Slots that points take before small triangles are thinned out, if `points` are left, at most.
    pub fn slots(&self, points: u32) -> f64 {
        let max_area = self.max_area(points, true);
        if !self.grows {
            return self.points(max_area, false);
        }
        // A triangle just over the largest area has six small ones.
        let triangles: u32 = self.chunks.iter().map(|chunk| chunk.data.triangles).sum();
        f64::from(triangles) + 6.0 * f64::from(points)
    }

    /// Points that `max_area` gives: the expected number if small triangles are thinned, else an upper bound.
    pub fn points(&self, max_area: f32, thin: bool) -> f64 {
        self.areas.points(max_area, thin)
    }
}
