//! What each VPL brings to one pixel: the gather's own functions, VPL by VPL, beside rays.

use super::stochastic::{Ranges, StochasticParams, is_coated};
use super::{PerPixelParams, Visibility, shadowed};
use crate::config::{Dielectric, Emitters, GatherConfig, Receiver};
use crate::graph::{Buffer, ComputePass, Graph};
use crate::shader_struct;
use crate::stages::interleave::Interleave;
use crate::stages::surroundings::Surroundings;
use crate::stages::vpls::Vpls;

shader_struct! {
    /// Share of a VPL in the light of one pixel: `glsl/gather/explain.comp`.
    pub struct VplShare {
        /// Place of the VPL.
        pub position: [f32; 3],
        /// Share of its light that the config's visibility leaves; below 0 where that says nothing of the pixel.
        pub seen: f32,
        /// Normal of the VPL.
        pub facing: [f32; 3],
        /// 1 if a ray reaches the VPL, 0 if not, or if no light would arrive.
        pub by_rays: f32,
        /// Radiant intensity towards the pixel, W/sr.
        pub intensity: [f32; 3],
        /// 1 if the pixel's sample set has the VPL.
        pub is_of_set: u32,
        /// Irradiance without shadows, sample sets and roulette, W/m^2.
        pub open: [f32; 3],
        /// Irradiance as the gather sums it, times the number of sample sets, W/m^2. 0 of light caches, which sum elsewhere.
        pub light: [f32; 3],
        /// Radiance that a glossy receiver reflects of it to the eye, W/(m^2 sr), times the number of sample sets.
        pub reflected: [f32; 3],
    }

    struct AskedBlock {
        pixel: [i32; 2],
    }

    struct ExplainDiskParams {
        count: u32,
    }
}

/// A pixel whose light is explained, and the frame around it.
#[derive(Clone, Copy)]
struct Asked<'f> {
    around: Surroundings<'f>,
    pixel: [u32; 2],
    interleave: Interleave,
}

impl<'f> Asked<'f> {
    fn of(around: Surroundings<'f>, interleave: Interleave) -> Option<Self> {
        around.asked.map(|pixel| Self { around, pixel, interleave })
    }

    /// Binds what all variants read, and dispatches.
    fn run(self, asked: Buffer, pass: ComputePass<'_>, vpls: &Vpls, shares: Buffer) {
        let Some(traced) = self.around.traced else { unreachable!("Renderer::inspect brings what rays need") };
        pass.traces(traced)
            .reads("view", self.around.gbuffer.view)
            .reads("depth", self.around.gbuffer.depth)
            .reads("normal", self.around.gbuffer.normal)
            .reads("places", vpls.places)
            .reads("intensities", vpls.intensities)
            .reads("asked", asked)
            .writes("shares", shares)
            .constant("BLOCK_ACROSS", self.interleave.across())
            .constant("BLOCK_DOWN", self.interleave.down())
            .dispatch([vpls.count, 1, 1]);
    }

    fn block(self, g: &mut Graph) -> Buffer {
        g.upload("gather/asked", &[AskedBlock { pixel: self.pixel.map(|n| n as i32) }])
    }
}

fn shares_of(g: &mut Graph, vpls: &Vpls) -> Buffer {
    g.buffer::<VplShare>("gather/shares", vpls.count)
}

/// [`VplShare`]s of a sum without roulette; `None` unless a pixel is asked about.
pub(super) fn vpl_shares(
    g: &mut Graph,
    around: Surroundings<'_>,
    vpls: &Vpls,
    visibility: Visibility,
    config: &GatherConfig,
) -> Option<Buffer> {
    let asked = Asked::of(around, around.wants.interleave)?;
    let (block, shares) = (asked.block(g), shares_of(g, vpls));
    let pass = shadowed(g, "gather/explain", visibility)
        .reads("areas", vpls.areas)
        .constant("DISKS", config.per_pixel.emitters == Emitters::Disks)
        .params(&PerPixelParams { count: vpls.count, squared_min_distance: config.min_distance * config.min_distance });
    asked.run(block, pass, vpls, shares);
    Some(shares)
}

/// [`VplShare`]s of a sum by roulette; `None` unless a pixel is asked about.
pub(super) fn roulette_shares(
    g: &mut Graph,
    around: Surroundings<'_>,
    vpls: &Vpls,
    visibility: Visibility,
    ranges: &Ranges,
    config: &GatherConfig,
) -> Option<Buffer> {
    let asked = Asked::of(around, around.wants.interleave)?;
    let (block, shares) = (asked.block(g), shares_of(g, vpls));
    let pass = shadowed(g, "gather/explain", visibility)
        .part("explain", "gather/explain-roulette")
        .reads("lobes", ranges.lobes)
        .reads("chances", ranges.chances)
        .reads("albedo", around.gbuffer.albedo)
        .reads("metallic_roughness", around.gbuffer.metallic_roughness)
        .constant("DIFFUSE", vpls.diffuse)
        .constant("LOBES", vpls.lobes.is_some())
        .constant("COATED", is_coated(vpls, around.wants.dielectric))
        .constant("GLOSSY_RECEIVER", config.stochastic.receiver == Receiver::Ggx)
        .constant("GLOSSY_DIELECTRIC", around.wants.dielectric == Dielectric::Ggx)
        .params(&StochasticParams::of(vpls, config));
    asked.run(block, pass, vpls, shares);
    Some(shares)
}

/// Light of VALs at the pixel itself. Light caches sum it elsewhere: no VAL has a share in their sum.
pub(super) fn disk_lights(g: &mut Graph, around: Surroundings<'_>, vpls: &Vpls) -> Option<Buffer> {
    let asked = Asked::of(around, Interleave::of(1.into()))?;
    let (block, shares) = (asked.block(g), shares_of(g, vpls));
    let pass = g.compute("gather/explain").part("explain", "gather/explain-disk");
    let pass = match vpls.disks {
        Some(disks) => pass.part("disk", "gather/disk-stored").reads("disks", disks),
        None => pass.reads("areas", vpls.areas),
    };
    asked.run(block, pass.params(&ExplainDiskParams { count: vpls.count }), vpls, shares);
    Some(shares)
}
