//! Stochastic light culling (Tokuyoshi and Harada 2017): VPLs shine as far as a random number each lets them.

use super::shells::{FrameShells, Shell};
use super::{Indirect, Visibility, shadowed};
use crate::config::{Bounds, Config, Dielectric, GatherConfig, Receiver, RouletteChoice};
use crate::gpu::Format;
use crate::graph::{Buffer, DrawList, Graph, Image};
use crate::shader_struct;
use crate::stages::gbuffer::GBuffer;
use crate::stages::visibility::Surroundings;
use crate::stages::vpls::{Lobe, Vpls};

shader_struct! {
    /// `glsl/lib/range.glsl`.
    pub struct Spheroid {
        pub row0: [f32; 3],
        pub depth: f32,
        pub row1: [f32; 3],
        pub centre: [f32; 3],
    }

    struct RangesParams {
        count: u32,
        delta: f32,
        seed: u32,
    }

    pub(super) struct StochasticParams {
        count: u32,
        squared_min_distance: f32,
        delta: f32,
    }

    struct StatisticsParams {
        size: [i32; 2],
    }
}

impl StochasticParams {
    pub(super) fn of(vpls: &Vpls, config: &GatherConfig) -> Self {
        Self { count: vpls.count, squared_min_distance: config.min_distance * config.min_distance, delta: config.stochastic.delta }
    }
}

/// What the random numbers of a frame start from.
#[derive(Debug, Clone, Copy)]
pub struct Roulette(u32);

impl Roulette {
    pub fn of(config: &Config, frame: u32) -> Self {
        Self(match config.gather.stochastic.roulette {
            RouletteChoice::Fixed | RouletteChoice::None => config.frame.seed,
            // Far from those of other seeds.
            RouletteChoice::PerFrame => config.frame.seed.wrapping_add(0x9e37_79b9_u32.wrapping_mul(frame + 1)),
        })
    }
}

/// A tile of 16 x 16 pixels of a sample set, whose lists are made and summed in one pass.
const TILE: u32 = 16;

/// Where the VPLs may shine.
pub(super) struct Ranges {
    /// Of the diffuse ones, in the view's space: centre and radius.
    pub spheres: Buffer,
    pub spheroids: Buffer,
    /// The random numbers of the diffuse VPL and of the lobe.
    pub chances: Buffer,
    /// The lobes, or what stands in their place where there are none.
    pub lobes: Buffer,
}

/// Range determination (sections 3 and 4).
pub(super) fn ranges(g: &mut Graph, gbuffer: &GBuffer, vpls: &Vpls, Roulette(seed): Roulette, config: &GatherConfig) -> Ranges {
    let lobes = vpls.lobes.unwrap_or_else(|| g.zeroed::<Lobe>("gather/no-lobes", 1));
    let ranges = Ranges {
        spheres: g.buffer::<[f32; 4]>("gather/spheres", vpls.count),
        spheroids: g.buffer::<Spheroid>("gather/spheroids", if vpls.lobes.is_some() { vpls.count } else { 1 }),
        chances: g.buffer::<[f32; 2]>("gather/chances", vpls.count),
        lobes,
    };
    g.compute("gather/ranges")
        .reads("view", gbuffer.view)
        .reads("places", vpls.places)
        .reads("intensities", vpls.intensities)
        .reads("lobes", lobes)
        .writes("spheres", ranges.spheres)
        .writes("spheroids", ranges.spheroids)
        .writes("chances", ranges.chances)
        .constant("LOBES", vpls.lobes.is_some())
        .constant("CLAMPED", config.stochastic.roulette == RouletteChoice::None)
        .constant(
            "BOUNDS",
            match config.stochastic.bounds {
                Bounds::Ellipsoid | Bounds::None => 0u32,
                Bounds::SphereEllipsoid => 1,
                Bounds::SphereVpl => 2,
            },
        )
        .params(&RangesParams { count: vpls.count, delta: config.stochastic.delta, seed })
        .dispatch([vpls.count, 1, 1]);
    ranges
}

/// Whether diffuse VPLs have a coat that takes its share of their light: where that shines as lobes.
pub(super) fn is_coated(vpls: &Vpls, dielectric: Dielectric) -> bool {
    dielectric == Dielectric::Ggx && vpls.lobes.is_some()
}

/// Bounding geometry of both kinds of VPLs' ranges, for a pass that tells them apart by its constant `GLOSSY`.
pub(super) fn bounds(g: &mut Graph, shells: FrameShells<'_>, vpls: &Vpls, shell: Shell, far_sides: bool) -> Vec<DrawList> {
    let mut lists = Vec::new();
    if vpls.diffuse {
        lists.push(shells.list(g, "gather/diffuse-bounds", shell, vpls.count, far_sides, vec![("GLOSSY", 0)]));
    }
    if vpls.lobes.is_some() {
        lists.push(shells.list(g, "gather/glossy-bounds", shell, vpls.count, far_sides, vec![("GLOSSY", 1)]));
    }
    lists
}

/// Culls by tiles and sums in one pass (section 5).
pub(super) fn tiled(
    g: &mut Graph,
    around: Surroundings<'_>,
    vpls: &Vpls,
    visibility: Visibility,
    roulette: Roulette,
    config: &GatherConfig,
) -> Indirect {
    let (gbuffer, interleave, dielectric) = (around.gbuffer, around.wants.interleave, around.wants.dielectric);
    let ranges = ranges(g, gbuffer, vpls, roulette, config);
    let irradiance = g.image("gather/irradiance", Format::Rgba16Float, gbuffer.size);
    let reflects = config.stochastic.receiver == Receiver::Ggx;
    let reflection = g.image("gather/reflection", Format::Rgba16Float, if reflects { gbuffer.size } else { [1, 1] });
    let numbers = g.image("gather/numbers", Format::Rgba32Float, if config.stochastic.statistics { gbuffer.size } else { [1, 1] });
    let groups = interleave.groups(gbuffer.size, [TILE, TILE]);
    shadowed(g, "gather/stochastic-tiled", visibility)
        .reads("view", gbuffer.view)
        .reads("depth", gbuffer.depth)
        .reads("normal", gbuffer.normal)
        .reads("places", vpls.places)
        .reads("intensities", vpls.intensities)
        .reads("lobes", ranges.lobes)
        .reads("spheres", ranges.spheres)
        .reads("spheroids", ranges.spheroids)
        .reads("chances", ranges.chances)
        .reads("albedo", gbuffer.albedo)
        .reads("metallic_roughness", gbuffer.metallic_roughness)
        .writes("numbers", numbers)
        .writes("reflection", reflection)
        .writes("irradiance", irradiance)
        .constant("INTERLEAVE", interleave.side())
        .constant("DIFFUSE", vpls.diffuse)
        .constant("LOBES", vpls.lobes.is_some())
        .constant("CULL", config.stochastic.bounds != Bounds::None)
        .constant("STATISTICS", config.stochastic.statistics)
        .constant("GLOSSY_RECEIVER", reflects)
        .constant("GLOSSY_DIELECTRIC", dielectric == Dielectric::Ggx)
        .constant("COATED", is_coated(vpls, dielectric))
        .params(&StochasticParams::of(vpls, config))
        .dispatch_groups([groups[0], groups[1], 1]);
    if config.stochastic.statistics {
        statistics(g, gbuffer, numbers);
    }
    Indirect { irradiance, reflection: reflects.then_some(reflection), pattern: interleave }
}

/// Pictures how many VPLs pixels have on their lists and how many of those do not shine on them (figures 9 and 10), and counts
/// `gather/pixels` and pairs of them and VPLs: `gather/diffuse-listed`, of which `gather/diffuse-lit` shine and `gather/diffuse-wrong` do not, and
/// likewise for glossy ones. A pixel's list is that of its own half of the tile; where pixels of both halves go together they walk both.
pub(super) fn statistics(g: &mut Graph, gbuffer: &GBuffer, numbers: Image) {
    let picture = g.image("gather/statistics", Format::Rgba8Unorm, gbuffer.size);
    let names = ["pixels", "diffuse-listed", "diffuse-lit", "diffuse-wrong", "glossy-listed", "glossy-lit", "glossy-wrong"];
    let [pixels, diffuse_listed, diffuse_lit, diffuse_wrong, glossy_listed, glossy_lit, glossy_wrong] =
        names.map(|name| g.count(&format!("gather/{name}")));
    g.compute("gather/statistics")
        .reads("depth", gbuffer.depth)
        .reads("numbers", numbers)
        .updates("pixels", pixels)
        .updates("diffuse_listed", diffuse_listed)
        .updates("diffuse_lit", diffuse_lit)
        .updates("diffuse_wrong", diffuse_wrong)
        .updates("glossy_listed", glossy_listed)
        .updates("glossy_lit", glossy_lit)
        .updates("glossy_wrong", glossy_wrong)
        .writes("picture", picture)
        .params(&StatisticsParams { size: gbuffer.size.map(|n| n as i32) })
        .dispatch([gbuffer.size[0], gbuffer.size[1], 1]);
}
