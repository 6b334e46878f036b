//! Virtual point lights, sampled from the reflective shadow maps.

mod importance;
mod inverse_transform;
mod metropolis_hastings;
pub(super) mod points;

pub use importance::{ViewSample, ViewSampleLobe};

use super::facts::Facts;
use super::gbuffer::GBuffer;
use super::methods::{Choice, NOTHING, Needs};
use super::rsm::Rsm;
use super::wants::Wants;
use crate::config::{Config, Evaluate, Importance, Reflection, Scan, VplSampler, VplsConfig, Weights};
use crate::fail;
use crate::gpu::Feature;
use crate::graph::{Buffer, ComputePass, Graph};
use crate::shader_struct;
use anyhow::Result;
use importance::TexelImportance;
use inverse_transform::Cumulative;
use points::TexelParams;

shader_struct! {
    /// `glsl/lib/vpl.glsl`.
    pub struct VplPlace {
        pub position: [f32; 3],
        /// Octahedral, two signed normalized 16-bit numbers.
        pub normal: u32,
    }

    /// `glsl/lib/lobe.glsl`.
    pub struct Lobe {
        /// Incident flux, W; 0 of a VPL without a glossy lobe.
        pub flux: [f32; 3],
        /// Interpolated surface normal, octahedral.
        pub normal: u32,
        /// Fresnel reflectance at normal incidence, times the glossy share of the surface.
        pub f0: [f32; 3],
        /// Direction to the light, octahedral.
        pub incoming: u32,
        /// GGX alpha: roughness squared.
        pub alpha: f32,
        /// Fresnel reflectance at grazing incidence, times the glossy share of the surface.
        pub f90: f32,
    }

    struct ImportanceParams {
        size: [u32; 2],
    }

    struct DistributionParams {
        layers: u32,
    }
}

/// VPLs, `count` elements in each buffer. Places are apart, so that visibility and culling read little (Linke 2016, section 4.3).
/// `src/stages/README.md` has the contract that every sampler keeps.
#[derive(Debug, Clone, Copy)]
pub struct Vpls {
    pub count: u32,
    /// [`VplPlace`].
    pub places: Buffer,
    /// Radiant intensity along the normal, W/sr, RGB.
    pub intensities: Buffer,
    /// Footprint: cross section of the beam that the VPL represents, m^2; 0 of a VPL without light, and of no other. It gives the size of
    /// disk emitters ([`Emitters::Disks`](crate::config::Emitters)).
    pub areas: Buffer,
    /// Area of each VPL's texel across the map's axis, and of all texels that it stands for, m^2: two floats each; there if
    /// [`Wants::disks`](super::wants::Wants) says so and VPLs are of texels.
    pub disks: Option<Buffer>,
    /// Estimated share of each VPL's light that stays in the scene; `None` if the sampler makes no estimate.
    pub kept: Option<Buffer>,
    /// Glossy VPLs at the same places, [`Lobe`]s; there if [`Wants::glossy`](super::wants::Wants) says so.
    pub lobes: Option<Buffer>,
    /// Whether diffuse VPLs shine.
    pub diffuse: bool,
}

/// Cells of the importance map along each side of a layer: `glsl/vpls/distribution.glsl`.
const CELLS: u32 = 64;

/// Distribution that samples are drawn from: running sums of the cells' importance.
#[derive(Debug, Clone, Copy)]
struct Distribution {
    columns: Buffer,
    rows: Buffer,
}

impl Choice for VplSampler {
    const KEY: &'static str = "vpls.sampler";

    fn needs(self) -> Needs {
        match self {
            Self::Regular | Self::Hammersley | Self::Uniform | Self::EveryTexel | Self::InverseTransform | Self::MetropolisHastings => {
                NOTHING
            }
        }
    }
}

impl Choice for Importance {
    const KEY: &'static str = "vpls.importance";

    fn needs(self) -> Needs {
        match self {
            Self::None | Self::PassedFlux => NOTHING,
            Self::View => &[&[Feature::SubgroupBallot]],
        }
    }
}

/// Refuses counts of VPLs below the number of maps or above the number of texels, where each map and texel has its share, and chains that a
/// buffer cannot hold.
pub fn check(config: &Config, facts: &Facts) -> Result<()> {
    let (count, maps, texels) = (u64::from(facts.vpls), u64::from(facts.maps), facts.texels);
    let draws = matches!(config.vpls.sampler, VplSampler::Uniform | VplSampler::InverseTransform | VplSampler::MetropolisHastings);
    if !draws && (count < maps || count > texels) {
        return Err(fail!(
            BadInput,
            "vpls.count: {count} is out of range, expected {maps} to {texels}: at least one for each shadow map, at most one a texel"
        ));
    }
    let proposals = count * u64::from(config.vpls.metropolis_hastings.steps);
    let most = facts.adapter.limits.storage_buffer_bytes.min(u64::from(u32::MAX)) / size_of::<f32>() as u64;
    let chains = &config.vpls.metropolis_hastings;
    let alone = chains.evaluate == Evaluate::Proposals && chains.weights != Weights::None;
    if config.vpls.sampler == VplSampler::MetropolisHastings && alone && proposals > most {
        return Err(fail!(
            BadInput,
            "vpls.metropolis_hastings.steps: {proposals} proposals of all chains are over the {most} that {} allows; lower it or vpls.count",
            facts.adapter.name
        ));
    }
    Ok(())
}

/// Samples VPLs with the config's sampler; `None` if no light has a map. Counts `vpls/lit`, VPLs with flux.
pub fn sample(g: &mut Graph, rsm: &Rsm, gbuffer: &GBuffer, wants: &Wants, config: &VplsConfig) -> Option<Vpls> {
    (rsm.layers > 0).then(|| of_maps(g, rsm, gbuffer, wants, config))
}

fn of_maps(g: &mut Graph, rsm: &Rsm, gbuffer: &GBuffer, wants: &Wants, config: &VplsConfig) -> Vpls {
    use VplSampler::{EveryTexel, Hammersley, InverseTransform, MetropolisHastings, Regular, Uniform};
    let texels = Texels { rsm, disks: wants.disks, diffuse: config.reflection != Reflection::Glossy };
    let params = |count, steps| TexelParams::new(rsm.size, rsm.layers, count, steps, wants);
    let one_each = params(config.count, 1);
    match (config.sampler, config.importance) {
        (Regular | Hammersley, Importance::View) => {
            let part = if config.sampler == Regular { "vpls/points-regular" } else { "vpls/points-hammersley" };
            let importance = TexelImportance::of(g, rsm, gbuffer, wants, config);
            let cumulative = Cumulative::of(g, &importance, rsm, Scan::Blocked);
            texels.chosen_by(g, "vpls/inverse-transform", &one_each, |pass| {
                cumulative.bind(pass).part("points", part).constant("ROW_BY_LIGHT", true)
            })
        }
        (Regular, _) => texels.chosen_by(g, "vpls/regular", &one_each, |pass| pass),
        (Hammersley, Importance::PassedFlux) => {
            let distribution = passed_flux(g, rsm);
            let kept = g.buffer::<f32>("vpls/kept", config.count);
            let vpls = texels.chosen_by(g, "vpls/important", &one_each, |pass| {
                pass.reads("columns", distribution.columns)
                    .reads("rows", distribution.rows)
                    .writes("kept", kept)
                    .constant("MORE_BESIDE", !rsm.covers_all)
            });
            Vpls { kept: Some(kept), ..vpls }
        }
        (Hammersley, _) => texels.chosen_by(g, "vpls/hammersley", &one_each, |pass| pass),
        (Uniform, _) => texels.chosen_by(g, "vpls/uniform", &one_each, |pass| pass.part("points", points::part(config))),
        (EveryTexel, _) => {
            let all = rsm.size[0] * rsm.size[1] * rsm.layers;
            texels.chosen_by(g, "vpls/every-texel", &params(all, 1), |pass| pass)
        }
        (InverseTransform, _) => {
            let importance = TexelImportance::of(g, rsm, gbuffer, wants, config);
            let cumulative = Cumulative::of(g, &importance, rsm, config.inverse_transform.scan);
            texels.chosen_by(g, "vpls/inverse-transform", &one_each, |pass| {
                let two = config.inverse_transform.dimensions == 2;
                cumulative.bind(pass).part("points", points::part(config)).constant("ROW_BY_LIGHT", two)
            })
        }
        (MetropolisHastings, _) => {
            let params = params(config.count, config.metropolis_hastings.steps);
            let importance = TexelImportance::of(g, rsm, gbuffer, wants, config);
            let proposed = metropolis_hastings::propose(g, &importance, rsm, &params, config);
            texels.chosen_by(g, "vpls/metropolis-hastings", &params, |pass| {
                proposed.bind(pass, &config.metropolis_hastings).part("points", points::part(config))
            })
        }
    }
}

/// Importance of the maps' cells: the flux that they send on into the scene.
fn passed_flux(g: &mut Graph, rsm: &Rsm) -> Distribution {
    let cells = CELLS * CELLS * rsm.layers;
    let importances = g.buffer::<f32>("vpls/importances", cells);
    g.compute("vpls/importance")
        .reads("lights", rsm.lights)
        .reads("rsm_depth", rsm.depth)
        .reads("rsm_normal", rsm.normal)
        .reads("rsm_flux", rsm.flux)
        .reads("rsm_albedo", rsm.albedo)
        .writes("importances", importances)
        .constant("MORE_BESIDE", !rsm.covers_all)
        .params(&ImportanceParams { size: rsm.size })
        .dispatch([CELLS, CELLS, rsm.layers]);
    let distribution =
        Distribution { columns: g.buffer::<f32>("vpls/columns", cells), rows: g.buffer::<f32>("vpls/rows", CELLS * rsm.layers) };
    g.compute("vpls/distribution")
        .reads("importances", importances)
        .writes("columns", distribution.columns)
        .writes("rows", distribution.rows)
        .params(&DistributionParams { layers: rsm.layers })
        .dispatch_groups([1, 1, 1]);
    distribution
}

/// Texels of the maps that become VPLs.
#[derive(Debug, Clone, Copy)]
struct Texels<'r> {
    rsm: &'r Rsm,
    /// Whether texels' areas are kept.
    disks: bool,
    /// Whether diffuse VPLs shine.
    diffuse: bool,
}

impl Texels<'_> {
    /// VPLs from the texels that a pass chooses; `bind` binds what the pass reads beside the maps.
    fn chosen_by(
        &self,
        g: &mut Graph,
        pass: &'static str,
        params: &TexelParams,
        bind: impl for<'g> FnOnce(ComputePass<'g>) -> ComputePass<'g>,
    ) -> Vpls {
        let (rsm, count) = (self.rsm, params.count);
        let vpls = Vpls {
            count,
            places: g.buffer::<VplPlace>("vpls/places", count),
            intensities: g.buffer::<[f32; 3]>("vpls/intensities", count),
            areas: g.buffer::<f32>("vpls/areas", count),
            disks: self.disks.then(|| g.buffer::<[f32; 2]>("vpls/disks", count)),
            kept: None,
            lobes: rsm.glossy.map(|_| g.buffer::<Lobe>("vpls/lobes", count)),
            diffuse: self.diffuse,
        };
        let lit = g.count("vpls/lit");
        let pass = bind(g.compute(pass));
        let pass = match (rsm.glossy, vpls.lobes) {
            (Some(texels), Some(lobes)) => pass
                .part("lobe", "vpls/lobe-stored")
                .reads("rsm_specular", texels.specular)
                .reads("rsm_lobe", texels.lobe)
                .writes("lobes", lobes),
            _ => pass,
        };
        let pass = match vpls.disks {
            Some(disks) => pass.part("disk", "vpls/disk-stored").writes("disks", disks),
            None => pass,
        };
        pass.reads("lights", rsm.lights)
            .reads("rsm_depth", rsm.depth)
            .reads("rsm_normal", rsm.normal)
            .reads("rsm_flux", rsm.flux)
            .reads("rsm_albedo", rsm.albedo)
            .writes("places", vpls.places)
            .writes("intensities", vpls.intensities)
            .writes("areas", vpls.areas)
            .updates("lit", lit)
            .params(params)
            .dispatch([count, 1, 1]);
        vpls
    }
}
