//! Gather: irradiance at every pixel from the VPLs.

pub mod caches;
mod conservative;
mod explain;
pub mod light_caches;
mod limits;
pub mod shells;
mod splatting;
mod statistics;
mod stochastic;

pub use explain::VplShare;
pub use limits::{MOST_TURNS, check, choices, methods, needs_rays, warnings, warnings_of_frame};
pub use statistics::means;
pub use stochastic::Roulette;

use super::gbuffer::GBuffer;
use super::interleave::Interleave;
use super::surroundings::Surroundings;
use super::visibility::{Ism, Visibility};
use super::vpls::Vpls;
use crate::config::{Culling, Emitters, GatherConfig, GatherMethod, Lookup, StochasticCulling, Tile};
use crate::gpu::Format;
use crate::graph::{Buffer, ComputePass, Graph, Image};
use crate::shader_struct;

shader_struct! {
    /// `glsl/gather/ism-lookup.glsl`.
    struct IsmBlock {
        far: f32,
        bias: f32,
        size: i32,
        columns: u32,
    }

    /// `glsl/gather/shadow-clusters.glsl`.
    struct ClustersBlock {
        far: f32,
        bias: f32,
        size: i32,
    }

    struct AddParams {
        size: [i32; 2],
    }

    struct FroxelListParams {
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

/// Indirect light at the receivers.
#[derive(Debug, Clone, Copy)]
pub struct Indirect {
    /// Irradiance, W/m^2; with glossy receivers less the part that a dielectric's coat reflects.
    pub irradiance: Image,
    /// Radiance that glossy receivers reflect to the eye; there if receivers are glossy: [`GatherConfig::has_glossy_receivers`].
    pub reflection: Option<Image>,
    /// Interleaving pattern of both images, for the filter to remove.
    pub pattern: Interleave,
    /// [`VplShare`]s of the pixel that is asked about; `None` of sums of several bounces, and if there is no such pixel.
    pub shares: Option<Buffer>,
}

/// Indirect light of all bounces.
#[derive(Debug, Clone)]
pub struct Gathered {
    pub light: Indirect,
    /// [`VplShare`]s of the pixel that is asked about, a buffer a bounce; none if there is no such pixel.
    pub shares: Vec<Buffer>,
}

/// Indirect light of all bounces' VPLs, by the config's method.
pub fn indirect(
    g: &mut Graph,
    around: Surroundings<'_>,
    lights: &[(Vpls, Visibility)],
    roulette: Roulette,
    config: &GatherConfig,
) -> Gathered {
    match (config.method, config.stochastic.culling) {
        (GatherMethod::LightCaches, _) => {
            sum_of(g, around, lights, |g, vpls, _| light_caches::gathered(g, around, vpls, &config.light_caches))
        }
        (GatherMethod::PerPixel, _) => sum_of(g, around, lights, |g, vpls, visibility| per_pixel(g, around, vpls, visibility, config)),
        (GatherMethod::Stochastic, StochasticCulling::Tiled) => {
            sum_of(g, around, lights, |g, vpls, visibility| stochastic::tiled(g, around, vpls, visibility, roulette, config))
        }
        (GatherMethod::Stochastic, StochasticCulling::Splatting) => {
            sum_of(g, around, lights, |g, vpls, _| splatting::splatting(g, around, vpls, roulette, config))
        }
        (GatherMethod::Stochastic, StochasticCulling::ConservativeClusters) => {
            sum_of(g, around, lights, |g, vpls, _| conservative::conservative_clusters(g, around, vpls, roulette, config))
        }
    }
}

/// Gathers each bounce by itself and sums the images. Without a bounce there is no light.
fn sum_of(
    g: &mut Graph,
    around: Surroundings<'_>,
    lights: &[(Vpls, Visibility)],
    one: impl Fn(&mut Graph, &Vpls, Visibility) -> Indirect,
) -> Gathered {
    if lights.is_empty() {
        return Gathered { light: dark(g, around), shares: Vec::new() };
    }
    let images: Vec<Indirect> =
        lights.iter().zip(1..).map(|((vpls, visibility), time)| g.again(time, |g| one(g, vpls, *visibility))).collect();
    let irradiance =
        total(g, ["gather/add", "gather/sum"], images.iter().map(|light| light.irradiance)).expect("there is a bounce at least");
    let reflection = total(g, ["gather/add-reflection", "gather/reflection-sum"], images.iter().filter_map(|light| light.reflection));
    let light = Indirect { irradiance, reflection, pattern: images[0].pattern, shares: None };
    Gathered { light, shares: images.iter().filter_map(|light| light.shares).collect() }
}

/// No light at all.
fn dark(g: &mut Graph, around: Surroundings<'_>) -> Indirect {
    let size = around.gbuffer.size;
    let irradiance = g.image("gather/irradiance", Format::Rgba16Float, size);
    g.compute("gather/dark")
        .writes("irradiance", irradiance)
        .params(&AddParams { size: size.map(|n| n as i32) })
        .dispatch([size[0], size[1], 1]);
    Indirect { irradiance, reflection: None, pattern: Interleave::of(1.into()), shares: None }
}

/// Sum of images, or `None` of none; `names` are the pass's and the image's.
fn total(g: &mut Graph, names: [&'static str; 2], mut images: impl Iterator<Item = Image>) -> Option<Image> {
    let first = images.next()?;
    Some(images.zip(1..).fold(first, |sum, (image, time)| g.again(time, |g| add(g, names, sum, image))))
}

fn add(g: &mut Graph, [pass, name]: [&'static str; 2], first: Image, second: Image) -> Image {
    let sum = g.image(name, Format::Rgba16Float, first.size);
    g.compute(pass)
        .shader("gather/add")
        .reads("first", first)
        .reads("second", second)
        .writes("irradiance", sum)
        .params(&AddParams { size: first.size.map(|n| n as i32) })
        .dispatch([first.size[0], first.size[1], 1]);
    sum
}

/// Sums one sample set of the VPLs at every pixel (Linke 2016, section 4.5), without VPLs that face away if there is culling.
fn per_pixel(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls, visibility: Visibility, config: &GatherConfig) -> Indirect {
    let (gbuffer, interleave) = (around.gbuffer, around.wants.interleave);
    let irradiance = g.image("gather/irradiance", Format::Rgba16Float, gbuffer.size);
    let square = config.per_pixel.culling == Culling::Tiled && config.per_pixel.tile == Tile::Square;
    let groups = interleave.groups(gbuffer.size, if square { [8, 8] } else { [16, 8] });
    let name = match config.per_pixel.culling {
        Culling::None => "gather/per-pixel",
        Culling::Tiled => "gather/tiled",
        Culling::Clustered => "gather/clustered",
    };
    let froxels = (config.per_pixel.culling == Culling::Clustered).then(|| froxels(g, gbuffer, vpls, interleave));
    let numbers = statistics::numbers(g, gbuffer, config.per_pixel.statistics);
    let mut pass = statistics::counting(shadowed(g, name, visibility), numbers);
    if square {
        pass = pass.part("tile", "gather/tile-square");
    }
    if let Some(Froxels { rows, lists, packed }) = froxels {
        pass = pass.reads("rows", rows).reads("lists", lists).constant("PARTS", parts(interleave)).constant("PACKED", packed);
    }
    pass.reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("places", vpls.places)
        .reads("intensities", vpls.intensities)
        .reads("areas", vpls.areas)
        .writes("irradiance", irradiance)
        .constant("DISKS", config.per_pixel.emitters == Emitters::Disks)
        .constant("BLOCK_ACROSS", interleave.across())
        .constant("BLOCK_DOWN", interleave.down())
        .params(&PerPixelParams { count: vpls.count, squared_min_distance: config.min_distance * config.min_distance })
        .dispatch_groups([groups[0], groups[1], 1]);
    statistics::counted(g, gbuffer, numbers);
    let shares = explain::vpl_shares(g, around, vpls, visibility, config);
    Indirect { irradiance, reflection: None, pattern: interleave, shares }
}

/// Begins a pass that looks up imperfect shadow maps.
pub(super) fn in_maps<'g>(g: &'g mut Graph, name: &'static str, ism: Ism) -> ComputePass<'g> {
    let block = IsmBlock { far: ism.far, bias: ism.bias, size: ism.size as i32, columns: ism.columns };
    let block = g.upload(&format!("{name}-ism"), &[block]);
    g.compute(name).reads("ism", block).reads("maps", ism.maps).constant("BILINEAR", ism.lookup == Lookup::Bilinear)
}

/// Begins a pass's variant for one kind of visibility, and binds the resources that this reads.
fn shadowed<'g>(g: &'g mut Graph, name: &'static str, visibility: Visibility) -> ComputePass<'g> {
    match visibility {
        Visibility::None => g.compute(name),
        Visibility::Bits(visible) => g.compute(name).part("seen", "gather/seen-bits").reads("visible", visible),
        Visibility::Ism(ism) => in_maps(g, name, ism).part("shadow", "gather/shadow-ism"),
        Visibility::SharedIsm { ism, labels, proxies } => {
            in_maps(g, name, ism).part("shadow", "gather/shadow-shared-ism").reads("labels", labels).reads("proxies", proxies)
        }
        Visibility::Clusters { clusters, bias, lookup } => {
            let block = g.upload(&format!("{name}-clusters"), &[ClustersBlock { far: clusters.far, bias, size: clusters.size as i32 }]);
            g.compute(name)
                .part("shadow", "gather/shadow-clusters")
                .reads("maps_of", block)
                .reads("maps", clusters.distances)
                .reads("clusters", clusters.clusters)
                .reads("labels", clusters.labels)
                .constant("BILINEAR", lookup == Lookup::Bilinear)
        }
    }
}

/// Light lists of the froxels that hold pixels.
struct Froxels {
    /// Number of a froxel's light list, by tile and slice; `glsl/gather/froxel.glsl`.
    rows: Buffer,
    /// Light lists in parts; `glsl/gather/light-list.glsl`.
    lists: Buffer,
    /// Numbers of VPLs in a word of the lists.
    packed: u32,
}

/// Pixels along a tile's side, and depth slices of a tile.
const TILE: u32 = 128;
const SLICES: u32 = 16;

/// Parts of a light list: a multiple of the sample sets, and at least 16, so that several invocations share the making of a list.
fn parts(interleave: Interleave) -> u32 {
    interleave.sets().max(16)
}

/// Light lists of the froxels that hold pixels (Linke 2016, section 4.6.1).
fn froxels(g: &mut Graph, gbuffer: &GBuffer, vpls: &Vpls, interleave: Interleave) -> Froxels {
    let [across, down] = gbuffer.size.map(|n| n.div_ceil(TILE));
    let tiles = across * down;
    let parts = parts(interleave);
    let slices = g.buffer::<u32>("gather/slices", tiles);
    let froxels = g.buffer::<u32>("gather/froxels", tiles * SLICES);
    let rows = g.buffer::<u32>("gather/rows", tiles * SLICES);
    // As few bits as a VPL's number within its part needs.
    let most = vpls.count.div_ceil(parts);
    let packed = if most <= 1 << 8 { 4 } else { u32::from(most <= 1 << 16) + 1 };
    let lists = g.buffer::<u32>("gather/lists", tiles * SLICES * parts * (1 + most.div_ceil(packed)));
    let used = g.count("gather/used-froxels");
    g.compute("gather/froxel-slices")
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .writes("slices", slices)
        .dispatch_groups([across, down, 1]);
    g.compute("gather/froxel-list")
        .reads("slices", slices)
        .writes("froxels", froxels)
        .writes("rows", rows)
        .updates("used", used)
        .params(&FroxelListParams { tiles })
        .dispatch_groups([1, 1, 1]);
    g.compute("gather/light-lists")
        .reads("view", gbuffer.view)
        .reads("places", vpls.places)
        .reads("intensities", vpls.intensities)
        .reads("froxels", froxels)
        .reads("used", used)
        .writes("lists", lists)
        .constant("PARTS", parts)
        .constant("PACKED", packed)
        .params(&LightListsParams { count: vpls.count })
        .dispatch_groups([tiles * SLICES, 1, 1]);
    Froxels { rows, lists, packed }
}
