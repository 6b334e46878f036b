//! Virtual point lights, sampled from the reflective shadow maps.

use super::facts::Facts;
use super::gbuffer::GBuffer;
use super::methods::{Choice, NOTHING, Needs};
use super::rsm::Rsm;
use crate::config::{Importance, Reflection, VplSampler, VplsConfig};
use crate::fail;
use crate::graph::{Buffer, Graph};
use crate::shader_struct;
use anyhow::Result;

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

    struct TexelParams {
        size: [u32; 2],
        lights: u32,
        count: u32,
    }
}

/// VPLs, `count` elements in each buffer. Places are apart, so that visibility and culling read little (Linke 2016, section 4.3).
/// `README.md` beside this file has the contract that every sampler keeps.
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
            Self::Regular | Self::Hammersley | Self::Uniform | Self::EveryTexel => NOTHING,
        }
    }
}

/// Refuses counts of VPLs below the number of maps or above the number of texels.
pub fn check(facts: &Facts) -> Result<()> {
    let (count, maps, texels) = (u64::from(facts.vpls), u64::from(facts.maps), facts.texels);
    if count < maps || count > texels {
        return Err(fail!(
            BadInput,
            "vpls.count: {count} is out of range, expected {maps} to {texels}: at least one for each shadow map, at most one a texel"
        ));
    }
    Ok(())
}

/// Samples VPLs with the config's sampler. Counts `vpls/lit`, VPLs with flux.
pub fn sample(g: &mut Graph, rsm: &Rsm, _gbuffer: &GBuffer, config: &VplsConfig) -> Vpls {
    let diffuse = config.reflection != Reflection::Glossy;
    match (config.sampler, config.importance) {
        (VplSampler::Regular, _) => from_texels(g, "vpls/regular", rsm, None, config.count, diffuse),
        (VplSampler::Hammersley, Importance::None) => from_texels(g, "vpls/hammersley", rsm, None, config.count, diffuse),
        (VplSampler::Hammersley, Importance::PassedFlux) => {
            let distribution = passed_flux(g, rsm);
            from_texels(g, "vpls/important", rsm, Some(distribution), config.count, diffuse)
        }
        (VplSampler::Uniform, _) => from_texels(g, "vpls/uniform", rsm, None, config.count, diffuse),
        (VplSampler::EveryTexel, _) => from_texels(g, "vpls/every-texel", rsm, None, rsm.size[0] * rsm.size[1] * rsm.layers, diffuse),
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

/// VPLs from texels that the pass selects, in the order of a fixed permutation.
fn from_texels(g: &mut Graph, pass: &'static str, rsm: &Rsm, distribution: Option<Distribution>, count: u32, diffuse: bool) -> Vpls {
    let vpls = Vpls {
        count,
        places: g.buffer::<VplPlace>("vpls/places", count),
        intensities: g.buffer::<[f32; 3]>("vpls/intensities", count),
        areas: g.buffer::<f32>("vpls/areas", count),
        kept: distribution.map(|_| g.buffer::<f32>("vpls/kept", count)),
        lobes: rsm.glossy.map(|_| g.buffer::<Lobe>("vpls/lobes", count)),
        diffuse,
    };
    let lit = g.count("vpls/lit");
    let pass = g.compute(pass);
    let pass = match (rsm.glossy, vpls.lobes) {
        (Some(texels), Some(lobes)) => pass
            .part("lobe", "vpls/lobe-stored")
            .reads("rsm_specular", texels.specular)
            .reads("rsm_lobe", texels.lobe)
            .writes("lobes", lobes),
        _ => pass,
    };
    let pass = match (distribution, vpls.kept) {
        (Some(Distribution { columns, rows }), Some(kept)) => {
            pass.reads("columns", columns).reads("rows", rows).writes("kept", kept).constant("MORE_BESIDE", !rsm.covers_all)
        }
        _ => pass,
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
        .params(&TexelParams { size: rsm.size, lights: rsm.layers, count })
        .dispatch([count, 1, 1]);
    vpls
}
