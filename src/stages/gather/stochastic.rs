//! Stochastic light culling (Tokuyoshi and Harada 2017): Russian roulette with one random number a VPL gives the VPL a finite range,
//! without bias.

use super::shells::{FrameShells, Shell};
use super::statistics::{counted, counting, numbers};
use super::{Indirect, Visibility, explain, shadowed};
use crate::config::{Bounds, Config, Dielectric, GatherConfig, Receiver, RouletteChoice};
use crate::gpu::Format;
use crate::graph::{Buffer, DrawList, Graph};
use crate::shader_struct;
use crate::stages::gbuffer::GBuffer;
use crate::stages::surroundings::Surroundings;
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
}

impl StochasticParams {
    pub(super) fn of(vpls: &Vpls, config: &GatherConfig) -> Self {
        Self { count: vpls.count, squared_min_distance: config.min_distance * config.min_distance, delta: config.stochastic.delta }
    }
}

/// Seed of a frame's Russian roulette.
#[derive(Debug, Clone, Copy)]
pub struct Roulette(u32);

impl Roulette {
    pub fn of(config: &Config, frame: u32) -> Self {
        Self(match config.gather.stochastic.roulette {
            RouletteChoice::Fixed | RouletteChoice::None => config.frame.seed,
            // A golden-ratio stride keeps the seeds of frames far from other seeds.
            RouletteChoice::PerFrame => config.frame.seed.wrapping_add(0x9e37_79b9_u32.wrapping_mul(frame + 1)),
        })
    }
}

/// Side of a tile, pixels of one sample set; its light lists are made and summed in one pass.
const TILE: u32 = 16;

/// Stochastic ranges of the VPLs.
#[derive(Clone, Copy)]
pub(super) struct Ranges {
    /// Ranges of diffuse VPLs, in view space: centre and radius.
    pub spheres: Buffer,
    pub spheroids: Buffer,
    /// Random numbers of the diffuse VPL and of the lobe.
    pub chances: Buffer,
    /// Lobes, or a buffer of one dark lobe if there are none.
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

/// Whether a glossy coat takes its Fresnel share out of diffuse VPLs: only if lobes carry that share.
pub(super) fn is_coated(vpls: &Vpls, dielectric: Dielectric) -> bool {
    dielectric == Dielectric::Ggx && vpls.lobes.is_some()
}

/// Hulls of both kinds of ranges, for a pass that distinguishes them by its constant `GLOSSY`.
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

/// Culls VPLs by tiles and sums them in one pass (section 5).
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
    let numbers = numbers(g, gbuffer, config.stochastic.statistics);
    let groups = interleave.groups(gbuffer.size, [TILE, TILE]);
    counting(shadowed(g, "gather/stochastic-tiled", visibility), numbers)
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
        .writes("reflection", reflection)
        .writes("irradiance", irradiance)
        .constant("BLOCK_ACROSS", interleave.across())
        .constant("BLOCK_DOWN", interleave.down())
        .constant("DIFFUSE", vpls.diffuse)
        .constant("LOBES", vpls.lobes.is_some())
        .constant("CULL", config.stochastic.bounds != Bounds::None)
        .constant("GLOSSY_RECEIVER", reflects)
        .constant("GLOSSY_DIELECTRIC", dielectric == Dielectric::Ggx)
        .constant("COATED", is_coated(vpls, dielectric))
        .params(&StochasticParams::of(vpls, config))
        .dispatch_groups([groups[0], groups[1], 1]);
    counted(g, gbuffer, numbers);
    let shares = explain::roulette_shares(g, around, vpls, visibility, &ranges, config);
    Indirect { irradiance, reflection: reflects.then_some(reflection), pattern: interleave, shares }
}
