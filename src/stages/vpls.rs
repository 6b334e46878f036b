//! Virtual point lights from the reflective shadow maps.

use super::gbuffer::GBuffer;
use super::rsm::Rsm;
use crate::config::{VplSampler, VplsConfig};
use crate::graph::{Buffer, Graph};
use crate::shader_struct;

shader_struct! {
    /// `glsl/lib/vpl.glsl`.
    pub struct VplPoint {
        pub position: [f32; 3],
        /// Octahedral, two signed normalized 16-bit numbers.
        pub normal: u32,
    }

    struct TexelParams {
        size: [u32; 2],
        lights: u32,
        count: u32,
    }
}

/// The VPLs: for visibility and culling their places alone, so that those read little (Linke 2016, section 4.3).
#[derive(Debug, Clone, Copy)]
pub struct Vpls {
    pub count: u32,
    pub points: Buffer,
    /// Radiant intensity along the normal, W/sr, RGB.
    pub intensities: Buffer,
    /// Of the beam that each stands for, across it, m^2: how large a disk it shines as ([`Emitters::Disks`](crate::config::Emitters)).
    pub areas: Buffer,
}

/// Fills the slot with the config's sampler.
pub fn sample(g: &mut Graph, rsm: &Rsm, _gbuffer: &GBuffer, config: &VplsConfig) -> Vpls {
    match config.sampler {
        VplSampler::Regular => from_texels(g, "vpls/regular", rsm, config.count),
        VplSampler::Hammersley => from_texels(g, "vpls/hammersley", rsm, config.count),
    }
}

/// Texels of each light's map, in the order of a fixed permutation; the pass says which. Counts `vpls/lit`, VPLs that have flux.
fn from_texels(g: &mut Graph, pass: &'static str, rsm: &Rsm, count: u32) -> Vpls {
    let vpls = Vpls {
        count,
        points: g.buffer::<VplPoint>("vpls/points", count),
        intensities: g.buffer::<[f32; 3]>("vpls/intensities", count),
        areas: g.buffer::<f32>("vpls/areas", count),
    };
    let lit = g.count("vpls/lit");
    g.compute(pass)
        .reads("lights", rsm.lights)
        .reads("rsm_depth", rsm.depth)
        .reads("rsm_normal", rsm.normal)
        .reads("rsm_flux", rsm.flux)
        .reads("rsm_albedo", rsm.albedo)
        .writes("points", vpls.points)
        .writes("intensities", vpls.intensities)
        .writes("areas", vpls.areas)
        .updates("lit", lit)
        .params(&TexelParams { size: rsm.size, lights: rsm.layers, count })
        .dispatch([count, 1, 1]);
    vpls
}
