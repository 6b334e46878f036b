//! Points from the scene's triangles, in one partition a VPL (Linke 2016, section 4.4.1). `glsl/visibility/point.glsl` has the rule.

use super::VisibilityConfig;
use super::ism::partition_capacity;
use super::triangles::ChunkData;
use crate::config::Collect;
use crate::graph::{Buffer, ComputePass, Graph};
use crate::shader_struct;
use crate::stages::surroundings::Surroundings;

shader_struct! {
    /// `glsl/visibility/point.glsl`.
    pub struct Point {
        pub position: [f32; 3],
        pub packed: u32,
    }

    /// Parameters of the passes that make points.
    pub struct PointsParams {
        /// Largest area of a small triangle, m^2.
        pub max_area: f32,
        /// Diagonal of the scene's bounds, metres.
        pub diagonal: f32,
        pub partitions: u32,
        pub capacity: u32,
        pub seed: u32,
    }
}

/// Points by partition.
#[derive(Debug, Clone, Copy)]
pub struct Points {
    /// Points of all partitions, one partition after the other.
    pub points: Buffer,
    /// Start of each partition, and the end of the last one.
    pub begins: Buffer,
    /// Points that were made for each partition. A partition has lost some if this is over its capacity.
    pub fill: Buffer,
    pub partitions: u32,
}

/// Makes the points with the method that the config chooses.
pub(super) fn collect(g: &mut Graph, around: Surroundings<'_>, partitions: u32, config: &VisibilityConfig) -> Points {
    let table = around.residents.triangles().table;
    let max_area = table.max_area(config.ism.point_count, config.ism.thin);
    let capacity = partition_capacity(config, table.points(max_area, config.ism.thin), partitions);
    let points = Points {
        points: g.buffer::<Point>("visibility/points", partitions * capacity),
        begins: g.upload::<u32>("visibility/begins", &(0..=partitions).map(|part| part * capacity).collect::<Vec<_>>()),
        fill: g.zeroed::<u32>("visibility/fill", partitions),
        partitions,
    };
    let diagonal = around.scene.bounds().size().length();
    let params = PointsParams { max_area, diagonal, partitions, capacity, seed: around.wants.seed };
    match config.ism.collect {
        Collect::Compute => computed(g, around, points, &params, config.ism.thin),
        Collect::Tessellation => tessellated(g, around, points, &params, config.ism.thin),
    }
    points
}

/// Points by a compute shader: an invocation a point.
fn computed(g: &mut Graph, around: Surroundings<'_>, points: Points, params: &PointsParams, thin: bool) {
    let (chunks, groups) = upload_chunks(g, around, params.max_area);
    goes_through(g.compute("visibility/points-computed"), around, chunks)
        .writes("points", points.points)
        .updates("fill", points.fill)
        .constant("THIN", thin)
        .params(params)
        .dispatch_groups([groups, 1, 1]);
}

/// The thesis's method: the tessellator subdivides, and the geometry stage makes the points.
fn tessellated(g: &mut Graph, around: Surroundings<'_>, points: Points, params: &PointsParams, thin: bool) {
    let patches = around.residents.triangles().table.patch_list(g, around.scene, "visibility/patches", params.max_area);
    g.raster("visibility/points-tessellated")
        .reads("draws", around.scene.draws)
        .writes("points", points.points)
        .updates("fill", points.fill)
        .constant("THIN", thin)
        .params(params)
        .draw(patches);
}

/// Uploads the triangles in chunks of one workgroup each, and returns their number.
pub(super) fn upload_chunks(g: &mut Graph, around: Surroundings<'_>, max_area: f32) -> (Buffer, u32) {
    let chunks = around.residents.triangles().table.chunks(max_area);
    (g.upload::<ChunkData>("visibility/chunks", &chunks), chunks.len() as u32)
}

/// Binds the buffers that `glsl/visibility/triangles.glsl` reads.
pub(super) fn goes_through<'g>(pass: ComputePass<'g>, around: Surroundings<'_>, chunks: Buffer) -> ComputePass<'g> {
    pass.reads("chunks", chunks)
        .reads("draws", around.scene.draws)
        .reads("positions", around.residents.triangles().positions)
        .reads("indices", around.scene.indices)
}
