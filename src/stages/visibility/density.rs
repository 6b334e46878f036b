//! How many points a triangle is turned into: the largest area of a small triangle, from all areas as they are in the frame. Where no area
//! changes with time the host knows it. Elsewhere the device works it out in every frame, so that a mesh that grows keeps its share of the
//! points, and all together stay as many as were asked for.

use super::triangles::ChunkData;
use crate::graph::{Buffer, ComputePass, DrawList, Graph};
use crate::shader_struct;
use crate::stages::surroundings::Surroundings;
use crate::world::device::{DrawArguments, VERTEX};

shader_struct! {
    /// `glsl/visibility/sizes.glsl`.
    pub struct PointSizes {
        pub max_area: f32,
    }

    struct AreaBin {
        count: u32,
        largest: u32,
    }

    /// Areas of a chunk's triangles, m^2.
    struct ChunkArea {
        sum: f32,
        largest: f32,
    }

    struct AreasParams {
        chunks: u32,
    }

    struct MaxAreaParams {
        points: u32,
        chunks: u32,
    }

    struct PartsParams {
        pieces: u32,
    }
}

/// `AREA_BINS` of `glsl/visibility/area-bin.glsl`.
const AREA_BINS: u32 = 4096;

/// Workgroups across a dispatch, at most: what every device has.
const MOST_GROUPS: u32 = 65_535;

/// Workgroups of a dispatch in rows; shaders pass by what is beyond.
pub(super) fn rows(groups: u32) -> [u32; 3] {
    [groups.min(MOST_GROUPS), groups.div_ceil(MOST_GROUPS), 1]
}

/// Density of points on the triangles.
#[derive(Debug, Clone, Copy)]
pub(super) struct Density {
    /// One [`PointSizes`].
    pub sizes: Buffer,
    /// Largest area of a small triangle, m^2, if all triangles are as large as they ever are.
    pub max_area: f32,
    /// Points of all triangles: the expected number if small triangles are thinned, else an upper bound.
    pub points: f64,
    pub thin: bool,
    /// Areas of the chunks in this frame, where they change.
    chunk_areas: Option<Buffer>,
}

/// The density that gives about `points` points.
pub(super) fn of(g: &mut Graph, around: Surroundings<'_>, points: u32, thin: bool) -> Density {
    let table = around.residents.triangles().table;
    let max_area = table.max_area(points, thin);
    let expected = table.points(max_area, thin);
    if !table.grows {
        let sizes = g.upload("visibility/sizes", &[PointSizes { max_area }]);
        return Density { sizes, max_area, points: expected, thin, chunk_areas: None };
    }
    let chunks = table.whole_chunks();
    let count = chunks.len() as u32;
    let bins = g.zeroed::<AreaBin>("visibility/area-bins", AREA_BINS);
    let chunk_areas = g.buffer::<ChunkArea>("visibility/chunk-areas", count);
    let sizes = g.buffer::<PointSizes>("visibility/sizes", 1);
    let chunks = g.upload::<ChunkData>("visibility/area-chunks", &chunks);
    goes_through(g.compute("visibility/areas"), around, chunks)
        .updates("bins", bins)
        .writes("chunk_areas", chunk_areas)
        .params(&AreasParams { chunks: count })
        .dispatch_groups(rows(count));
    g.compute("visibility/max-area")
        .reads("bins", bins)
        .reads("chunk_areas", chunk_areas)
        .writes("found", sizes)
        .constant("THIN", thin)
        .params(&MaxAreaParams { points, chunks: count })
        .dispatch_groups([1, 1, 1]);
    // Triangles of other sizes may be turned into the number asked for where the largest ones cannot.
    Density { sizes, max_area, points: expected.max(f64::from(points)), thin, chunk_areas: Some(chunk_areas) }
}

impl Density {
    /// All triangles as patches to tessellate, without culling: those with masks, if there are any, and then those without.
    pub fn patch_lists(&self, g: &mut Graph, around: Surroundings<'_>) -> Vec<(bool, Vec<DrawList>)> {
        let patches = around.residents.triangles().table.patches(self.max_area);
        if patches.is_empty() {
            return vec![(false, Vec::new())];
        }
        let whole = patches.iter().filter(|patches| !patches.masked).count() as u32;
        let arguments: Vec<DrawArguments> = patches.iter().map(|patches| patches.arguments).collect();
        let arguments = g.upload("visibility/patches", &arguments);
        if let Some(chunk_areas) = self.chunk_areas {
            let pieces: Vec<[u32; 2]> = patches.iter().map(|patches| [patches.first_chunk, patches.chunks]).collect();
            let count = pieces.len() as u32;
            let pieces = g.upload("visibility/patch-pieces", &pieces);
            g.compute("visibility/patch-parts")
                .reads("pieces", pieces)
                .reads("chunk_areas", chunk_areas)
                .reads("sizes", self.sizes)
                .updates("arguments", arguments)
                .params(&PartsParams { pieces: count })
                .dispatch([count, 1, 1]);
        }
        let all = DrawList::new(VERTEX, [around.scene.vertices, around.scene.indices], arguments);
        let parts = [(true, whole, all.count - whole), (false, 0, whole)].into_iter().filter(|(.., count)| *count > 0);
        parts.map(|(masked, first, count)| (masked, vec![DrawList { first, count, ..all.clone() }])).collect()
    }

    /// Uploads the triangles in chunks of one workgroup each.
    pub fn upload_chunks(&self, g: &mut Graph, around: Surroundings<'_>) -> Chunks {
        let (chunks, whole) = around.residents.triangles().table.chunks(self.max_area);
        Chunks { chunks: g.upload::<ChunkData>("visibility/chunks", &chunks), whole: whole as u32, count: chunks.len() as u32 }
    }
}

/// [`ChunkData`] of all chunks: first those without masks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chunks {
    pub chunks: Buffer,
    /// Chunks without masks.
    pub whole: u32,
    pub count: u32,
}

impl Chunks {
    /// The first chunk and the number of chunks of each dispatch, the masked ones' first. They are apart, since a software driver runs the
    /// code of masks even where no triangle has one.
    pub fn parts(&self) -> impl Iterator<Item = (bool, [u32; 2])> {
        let parts = [(true, [self.whole, self.count - self.whole]), (false, [0, self.whole])];
        // Something must write what others read, even if the scene has no triangle.
        let none = self.count == 0;
        parts.into_iter().filter(move |(masked, [_, count])| *count > 0 || (none && !masked))
    }
}

/// Binds the buffers that `glsl/visibility/chunk.glsl` reads.
pub(super) fn goes_through<'g>(pass: ComputePass<'g>, around: Surroundings<'_>, chunks: Buffer) -> ComputePass<'g> {
    pass.reads("chunks", chunks)
        .reads("draws", around.scene.draws)
        .reads("positions", around.residents.triangles().positions)
        .reads("indices", around.scene.indices)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_hold_all_workgroups_and_are_no_longer_than_devices_allow() {
        for groups in [0, 1, 65_535, 65_536, 200_000, u32::MAX] {
            let [across, down, _] = rows(groups);
            assert!(across <= 65_535 && down <= 65_538 && u64::from(across) * u64::from(down) >= u64::from(groups), "{groups}");
        }
    }
}
