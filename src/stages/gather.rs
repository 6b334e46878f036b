//! Irradiance at every pixel from the VPLs.

use super::gbuffer::GBuffer;
use super::visibility::Visibility;
use super::vpls::Vpls;
use crate::config::{Culling, GatherConfig, GatherMethod, Lookup};
use crate::gpu::Format;
use crate::graph::{Buffer, Graph, Image};
use crate::shader_struct;

shader_struct! {
    /// `glsl/gather/ism.glsl`.
    struct IsmBlock {
        far: f32,
        bias: f32,
        size: i32,
        columns: u32,
    }

    struct ClusterListParams {
        tiles: u32,
    }

    struct LightListsParams {
        count: u32,
    }

    struct PerPixelParams {
        count: u32,
        squared_min_distance: f32,
    }
}

/// llvmpipe ends an invocation's loops after 65,535 turns in all, without a word; `glsl/gather/per-pixel.glsl` takes at most
/// two turns for four VPLs.
pub const MOST_VPLS_A_PIXEL: u64 = 100_000;

/// Fills the slot with the config's method; the image holds indirect irradiance, W/m^2.
pub fn indirect(g: &mut Graph, gbuffer: &GBuffer, vpls: &Vpls, visibility: Visibility, config: &GatherConfig) -> Image {
    match config.method {
        GatherMethod::PerPixel => per_pixel(g, gbuffer, vpls, visibility, config),
    }
}

/// VPLs that each pixel sums, at most.
pub fn vpls_a_pixel(count: u32, interleave: u32) -> u32 {
    count.div_ceil(interleave * interleave)
}

/// Workgroups of one sample set each that cover the picture; one shades 8 x 4 times `pixels` pixels of its set.
pub(super) fn groups_of_sets(size: [u32; 2], interleave: u32, pixels: [u32; 2]) -> [u32; 2] {
    [0, 1].map(|axis| size[axis].div_ceil([8, 4][axis] * pixels[axis] * interleave) * interleave)
}

/// Every pixel takes one of every `interleave^2` VPLs (Linke 2016, section 4.5), but for those that cannot shine on it.
fn per_pixel(g: &mut Graph, gbuffer: &GBuffer, vpls: &Vpls, visibility: Visibility, config: &GatherConfig) -> Image {
    let irradiance = g.image("gather/irradiance", Format::Rgba16Float, gbuffer.size);
    let n = config.interleave;
    let groups = groups_of_sets(gbuffer.size, n, [2, 2]);
    let clusters = match config.culling {
        Culling::Clustered => Some(clusters(g, gbuffer, vpls, n)),
        Culling::None | Culling::Tiled => None,
    };
    let names = match config.culling {
        Culling::None => ["gather/per-pixel", "gather/per-pixel-visible", "gather/per-pixel-ism"],
        Culling::Tiled => ["gather/tiled", "gather/tiled-visible", "gather/tiled-ism"],
        Culling::Clustered => ["gather/clustered", "gather/clustered-visible", "gather/clustered-ism"],
    };
    let mut pass = match visibility {
        Visibility::None => g.compute(names[0]),
        Visibility::Bits(visible) => g.compute(names[1]).reads("visible", visible),
        Visibility::Ism(ism) => {
            let block = IsmBlock { far: ism.far, bias: ism.bias, size: ism.size as i32, columns: ism.columns };
            let block = g.upload("gather/ism", &[block]);
            g.compute(names[2]).reads("ism", block).reads("maps", ism.maps).constant("BILINEAR", ism.lookup == Lookup::Bilinear)
        }
    };
    if let Some(clusters) = clusters {
        pass = pass.reads("rows", clusters.rows).reads("lists", clusters.lists).constant("PARTS", parts(n));
    }
    pass.reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("points", vpls.points)
        .reads("intensities", vpls.intensities)
        .writes("irradiance", irradiance)
        .constant("INTERLEAVE", n)
        .params(&PerPixelParams { count: vpls.count, squared_min_distance: config.min_distance * config.min_distance })
        .dispatch_groups([groups[0], groups[1], 1]);
    irradiance
}

/// The light lists of those clusters that hold pixels.
struct Clusters {
    /// A cluster's list, by tile and slice; `glsl/gather/cluster.glsl`.
    rows: Buffer,
    /// Lists in parts: how many VPLs are in the part, and which.
    lists: Buffer,
}

/// Pixels of a tile's side, and slices of its depth.
const TILE: u32 = 128;
const SLICES: u32 = 16;

/// Parts of a light list: whole sets of pixels' VPLs, and 16 at least, so that lists are made by several invocations.
fn parts(interleave: u32) -> u32 {
    (interleave * interleave).max(16)
}

/// Finds the clusters, and which VPLs shine into each (Linke 2016, section 4.6.1).
fn clusters(g: &mut Graph, gbuffer: &GBuffer, vpls: &Vpls, interleave: u32) -> Clusters {
    let [across, down] = gbuffer.size.map(|n| n.div_ceil(TILE));
    let tiles = across * down;
    let parts = parts(interleave);
    let slices = g.buffer::<u32>("gather/slices", tiles);
    let clusters = g.buffer::<u32>("gather/clusters", tiles * SLICES);
    let rows = g.buffer::<u32>("gather/rows", tiles * SLICES);
    let lists = g.buffer::<u32>("gather/lists", tiles * SLICES * parts * (1 + vpls.count.div_ceil(parts)));
    let used = g.count("gather/used-clusters");
    g.compute("gather/cluster-slices")
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .writes("slices", slices)
        .dispatch_groups([across, down, 1]);
    g.compute("gather/cluster-list")
        .reads("slices", slices)
        .writes("clusters", clusters)
        .writes("rows", rows)
        .updates("used", used)
        .params(&ClusterListParams { tiles })
        .dispatch_groups([1, 1, 1]);
    g.compute("gather/light-lists")
        .reads("view", gbuffer.view)
        .reads("points", vpls.points)
        .reads("intensities", vpls.intensities)
        .reads("clusters", clusters)
        .reads("used", used)
        .writes("lists", lists)
        .constant("PARTS", parts)
        .params(&LightListsParams { count: vpls.count })
        .dispatch_groups([tiles * SLICES, 1, 1]);
    Clusters { rows, lists }
}
