//! Points from the scene's triangles, in one partition a VPL (Linke 2016, section 4.4.1). `glsl/visibility/point.glsl` has the rule.

use super::VisibilityConfig;
use super::density::{self, Density, goes_through, rows};
use super::ism::partition_capacity;
use super::masks::masked;
use super::stored::FrameSegment;
use crate::config::Collect;
use crate::graph::{Buffer, Graph};
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
        /// Diagonal of the scene's bounds, metres.
        pub diagonal: f32,
        pub partitions: u32,
        /// Partition of the buffer's first points, and how many partitions are in the buffer.
        pub first: u32,
        pub held: u32,
        pub capacity: u32,
        pub seed: u32,
        /// Chunk of the first workgroup, and the one after the last.
        pub chunk: u32,
        pub end: u32,
    }

    struct StoredParams {
        diagonal: f32,
        count: u32,
    }

    struct TotalParams {
        count: u32,
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
    /// Partitions in the buffers.
    pub partitions: u32,
    /// VPL of the first partition.
    pub first: u32,
    /// Points of a partition, about.
    pub each: u32,
    /// Whether slots may be empty.
    pub gaps: bool,
}

/// Makes the points with the method that the config chooses. Counts `visibility/made-points`, points of the surfaces, and, where surfaces are
/// masked, `visibility/points-in-holes`: those of them that were left out.
pub(super) fn collect(g: &mut Graph, around: Surroundings<'_>, partitions: u32, config: &VisibilityConfig) -> Vec<Points> {
    g.tell("visibility/asked-points", u64::from(config.ism.point_count));
    let holes = around.scene.masks.map(|_| g.count("visibility/points-in-holes"));
    if config.ism.collect == Collect::Stored {
        return stored(g, around, partitions, config, holes);
    }
    let table = around.residents.triangles().table;
    let density = density::of(g, around, config.ism.point_count, config.ism.thin);
    let capacity = partition_capacity(config, density.points, partitions);
    let held = table.most_bytes / (size_of::<Point>() as u64 * u64::from(capacity));
    let batches = u64::from(partitions).div_ceil(held.max(1)) as u32;
    let held = partitions.div_ceil(batches);
    let made = g.count("visibility/made-points");
    let diagonal = around.scene.bounds().size().length();
    let batch = |(number, first): (u32, u32), g: &mut Graph| {
        let held = held.min(partitions - first);
        let points = Points {
            points: g.buffer::<Point>("visibility/points", held * capacity),
            begins: g.upload::<u32>("visibility/begins", &(0..=held).map(|part| part * capacity).collect::<Vec<_>>()),
            fill: g.zeroed::<u32>("visibility/fill", held),
            partitions: held,
            first,
            each: capacity,
            gaps: false,
        };
        let params = PointsParams { diagonal, partitions, first, held, capacity, seed: around.wants.seed, chunk: 0, end: 0 };
        // Every batch goes through all triangles, and the first one counts.
        let counted = holes.filter(|_| number == 1);
        match config.ism.collect {
            Collect::Tessellation => tessellated(g, around, points, &params, &density, counted),
            Collect::Compute | Collect::Stored => computed(g, around, points, &params, &density, counted),
        }
        total(g, "visibility/points-total", points.fill, made);
        points
    };
    let batches = (1..).zip((0..partitions).step_by(held as usize));
    let all = batches.map(|each| g.again(each.0, |g| batch(each, g))).collect();
    if let Some(holes) = holes {
        total(g, "visibility/points-total-of-holes", holes, made);
    }
    all
}

/// Points by a compute shader: an invocation a point.
fn computed(g: &mut Graph, around: Surroundings<'_>, points: Points, params: &PointsParams, density: &Density, holes: Option<Buffer>) {
    let chunks = density.upload_chunks(g, around);
    for (masked, [chunk, groups]) in chunks.parts() {
        let name = if masked { "visibility/points-computed-masked" } else { "visibility/points-computed" };
        let pass = goes_through(g.compute(name).shader("visibility/points-computed"), around, chunks.chunks);
        let pass = if masked { masked!(pass, around, holes) } else { pass };
        pass.reads("sizes", density.sizes)
            .writes("points", points.points)
            .updates("fill", points.fill)
            .constant("THIN", density.thin)
            .params(&PointsParams { chunk, end: chunk + groups, ..*params })
            .dispatch_groups(rows(groups));
    }
}

/// The thesis's method: the tessellator subdivides, and the geometry stage makes the points.
fn tessellated(g: &mut Graph, around: Surroundings<'_>, points: Points, params: &PointsParams, density: &Density, holes: Option<Buffer>) {
    for (masked, patches) in density.patch_lists(g, around) {
        let name = if masked { "visibility/points-tessellated-masked" } else { "visibility/points-tessellated" };
        let pass = g.raster(name).shader("visibility/points-tessellated");
        let pass = if masked { masked!(pass, around, holes) } else { pass };
        pass.reads("draws", around.scene.draws)
            .reads("sizes", density.sizes)
            .writes("points", points.points)
            .updates("fill", points.fill)
            .constant("THIN", density.thin)
            .params(params)
            .draw(patches);
    }
}

/// Stored points (Barak et al. 2013, section 5.1): made once, and moved with their triangles. Their order spreads any range of them over
/// all surfaces, so that a partition is a range.
fn stored(g: &mut Graph, around: Surroundings<'_>, partitions: u32, config: &VisibilityConfig, holes: Option<Buffer>) -> Vec<Points> {
    let segments = around.residents.stored(g, config.ism.point_count, config.ism.thin);
    g.tell("visibility/made-points", segments.iter().map(|segment| u64::from(segment.records.count)).sum());
    let diagonal = around.scene.bounds().size().length();
    let segment = |(number, segment): (u32, FrameSegment), g: &mut Graph| {
        let count = segment.records.count;
        let begin = |part: u32| (u64::from(part) * u64::from(count) / u64::from(partitions)) as u32;
        let fill: Vec<u32> = (0..partitions).map(|part| begin(part + 1) - begin(part)).collect();
        let points = Points {
            points: g.buffer::<Point>("visibility/points", count),
            begins: g.upload::<u32>("visibility/begins", &(0..=partitions).map(begin).collect::<Vec<_>>()),
            fill: g.upload::<u32>("visibility/fill", &fill),
            partitions,
            first: turn(around.wants.seed, number, partitions),
            each: count / partitions,
            gaps: true,
        };
        let groups = count.div_ceil(64);
        let pass = g.compute("visibility/points-stored");
        masked!(pass, around, holes)
            .reads("records", segment.records)
            .reads("triangles", segment.triangles)
            .reads("draws", around.scene.draws)
            .reads("positions", around.residents.triangles().positions)
            .writes("points", points.points)
            .params(&StoredParams { diagonal, count })
            .dispatch_groups(rows(groups));
        points
    };
    (1..).zip(segments).map(|each| g.again(each.0, |g| segment(each, g))).collect()
}

/// VPL of a segment's first partition: stored points are the same for all seeds, and a seed gives them to other VPLs.
pub(super) fn turn(seed: u32, segment: u32, partitions: u32) -> u32 {
    let turned = seed.wrapping_mul(0x9e37_79b1).wrapping_add((segment - 1).wrapping_mul(0x85eb_ca6b));
    ((u64::from(turned) * u64::from(partitions)) >> 32) as u32
}

/// Adds all numbers of a buffer to a counter.
pub(super) fn total(g: &mut Graph, name: &'static str, numbers: Buffer, total: Buffer) {
    let pass = g.compute(name).shader("visibility/points-total").reads("numbers", numbers).updates("total", total);
    pass.params(&TotalParams { count: numbers.count }).dispatch_groups([1, 1, 1]);
}
