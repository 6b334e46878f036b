//! Points as squares of their size, by the rasterizer (Linke 2016, section 4.4.2; Barak et al. 2013, section 5).

use super::VisibilityConfig;
use super::density::{self, goes_through, rows};
use super::ism::{ClearParams, Projection, collected, considered, layout};
use super::masks::masked;
use super::points::{PointsParams, turn};
use super::stored::{FrameSegment, RECORD};
use crate::config::{Collect, SplatDepth};
use crate::gpu::Format;
use crate::graph::{Buffer, DrawList, Graph, Image, RasterPass};
use crate::shader_struct;
use crate::stages::surroundings::Surroundings;
use crate::stages::vpls::Vpls;

shader_struct! {
    /// `glsl/visibility/splat.glsl`.
    struct SplatBlock {
        size: [i32; 2],
        columns: u32,
        considered: u32,
        collected: u32,
        far: f32,
        enlarge: f32,
        largest: f32,
    }

    /// `VkDrawIndirectCommand`.
    struct PointArguments {
        vertex_count: u32,
        instance_count: u32,
        first_vertex: u32,
        first_instance: u32,
    }

    struct StoredSplatParams {
        diagonal: f32,
        partitions: u32,
        first: u32,
        spacing: u32,
    }
}

/// Default growth of radii: see the others in `ism`.
const SPLAT_ENLARGE: f32 = 0.9;

/// Draws the points of the config's choice into the maps. Counts `visibility/made-points`.
pub(super) fn render(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls, projection: Projection, config: &VisibilityConfig) -> Image {
    let [columns, rows] = layout(vpls.count);
    let size = [columns * config.ism.map_size, rows * config.ism.map_size];
    let splats = g.image("visibility/splats", Format::Depth32, size);
    let maps = g.image("visibility/maps", Format::R32Float, size);
    let block = g.upload(
        "visibility/splat",
        &[SplatBlock {
            size: size.map(|n| n as i32),
            columns,
            considered: considered(config, vpls.count),
            collected: collected(config, vpls.count),
            far: around.scene.bounds().size().length(),
            enlarge: config.ism.enlarge.unwrap_or(SPLAT_ENLARGE),
            largest: config.ism.largest_splat.unwrap_or(config.ism.map_size) as f32,
        }],
    );
    let drawing = Drawing { around, vpls, projection, config, block, splats };
    g.tell("visibility/asked-points", u64::from(config.ism.point_count));
    match config.ism.collect {
        Collect::Stored => {
            let segments = around.residents.stored(g, config.ism.point_count, config.ism.thin);
            g.tell("visibility/made-points", segments.iter().map(|segment| u64::from(segment.records.count)).sum());
            if segments.is_empty() {
                // A scene without area: the maps are empty.
                g.raster("visibility/splat-stored").depth(splats).draw(Vec::new());
            }
            for (number, segment) in (1..).zip(segments) {
                g.again(number, |g| drawing.stored(g, number, segment));
            }
        }
        Collect::Tessellation | Collect::Compute => drawing.tessellated(g),
    }
    g.compute("visibility/splat-distances")
        .reads("splats", splats)
        .writes("maps", maps)
        .params(&ClearParams { size: size.map(|n| n as i32) })
        .dispatch([size[0], size[1], 1]);
    maps
}

/// Inputs and target of the passes that draw squares.
struct Drawing<'f> {
    around: Surroundings<'f>,
    vpls: &'f Vpls,
    projection: Projection,
    config: &'f VisibilityConfig,
    /// The uniform block.
    block: Buffer,
    splats: Image,
}

impl Drawing<'_> {
    /// Begins a pass, and binds what places a square in its map.
    fn pass<'g>(&self, g: &'g mut Graph, name: &'static str) -> RasterPass<'g> {
        let Self { around, vpls, projection, config, .. } = self;
        let pass = g.raster(name);
        let pass = match projection {
            Projection::Paraboloid => pass,
            Projection::Orthographic(frames) => pass.part("projection", "visibility/projection-orthographic").reads("frames", *frames),
        };
        let plane = match projection {
            Projection::Paraboloid => "visibility/plane-paraboloid",
            Projection::Orthographic(_) => "visibility/plane-orthographic",
        };
        let pass = match config.ism.splat_depth {
            SplatDepth::Center => pass,
            SplatDepth::Plane => {
                pass.part("square", "visibility/square-plane").part("depth", "visibility/depth-plane").part("plane", plane)
            }
        };
        pass.reads("draws", around.scene.draws)
            .reads("places", vpls.places)
            .reads("splat", self.block)
            .constant("MAP_SIZE", config.ism.map_size)
            .constant("DISTORTION", config.ism.distortion)
            .constant("CLAMP", config.ism.clamp)
    }

    /// Draws squares directly from the tessellator.
    fn tessellated(&self, g: &mut Graph) {
        let Self { around, vpls, config, splats, .. } = *self;
        let density = density::of(g, around, config.ism.point_count, config.ism.thin);
        let diagonal = around.scene.bounds().size().length();
        let (partitions, seed) = (vpls.count, around.wants.seed);
        let params = PointsParams { diagonal, partitions, first: 0, held: partitions, capacity: 0, seed, chunk: 0, end: 0 };
        // A geometry stage that may emit many points is slow even where it emits one.
        let most = if collected(config, vpls.count) > 1 { "visibility/most-several" } else { "visibility/most-one" };
        let mut first = true;
        for (masked, patches) in density.patch_lists(g, around) {
            let name = if masked { "visibility/splat-masked" } else { "visibility/splat" };
            let pass = self.pass(g, name).shader("visibility/splat").part("most", most);
            let pass = if masked { masked!(pass, around, None::<Buffer>) } else { pass };
            let pass = pass.reads("sizes", density.sizes).constant("THIN", config.ism.thin).params(&params);
            let pass = if first { pass.depth(splats) } else { pass.depth_over(splats) };
            pass.draw(patches);
            first = false;
        }
        let made = g.count("visibility/made-points");
        let chunks = density.upload_chunks(g, around);
        goes_through(g.compute("visibility/points-counted"), around, chunks.chunks)
            .reads("sizes", density.sizes)
            .updates("made", made)
            .constant("THIN", config.ism.thin)
            .params(&PointsParams { end: chunks.count, ..params })
            .dispatch_groups(rows(chunks.count));
    }

    /// Draws squares of one segment of stored points.
    fn stored(&self, g: &mut Graph, number: u32, segment: FrameSegment) {
        let Self { around, vpls, config, splats, .. } = *self;
        let count = segment.records.count;
        let arguments =
            PointArguments { vertex_count: count, instance_count: collected(config, vpls.count), first_vertex: 0, first_instance: 0 };
        let arguments = g.upload("visibility/splat-arguments", &[arguments]);
        let pass = self.pass(g, "visibility/splat-stored");
        let pass = masked!(pass, around, None::<Buffer>)
            .reads("triangles", segment.triangles)
            .reads("positions", around.residents.triangles().positions)
            .params(&StoredSplatParams {
                diagonal: around.scene.bounds().size().length(),
                partitions: vpls.count,
                first: turn(around.wants.seed, number, vpls.count),
                spacing: u32::try_from((1u64 << 32) / u64::from(count)).unwrap_or(u32::MAX),
            });
        let pass = if number == 1 { pass.depth(splats) } else { pass.depth_over(splats) };
        pass.draw(vec![DrawList::points(RECORD, segment.records, arguments)]);
    }
}
