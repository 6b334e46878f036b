//! Virtual point lights from the reflective shadow maps.

use super::gbuffer::GBuffer;
use super::rsm::Rsm;
use crate::config::{Reflection, VplSampler, VplsConfig};
use crate::graph::{Buffer, Graph};
use crate::shader_struct;

shader_struct! {
    /// `glsl/lib/vpl.glsl`.
    pub struct VplPoint {
        pub position: [f32; 3],
        /// Octahedral, two signed normalized 16-bit numbers.
        pub normal: u32,
    }

    /// `glsl/lib/lobe.glsl`.
    pub struct Lobe {
        /// That arrives, W; 0 where nothing is reflected so.
        pub flux: [f32; 3],
        /// The surface's interpolated one, octahedral.
        pub normal: u32,
        /// Fresnel reflectance along the normal, times how much of the surface reflects so.
        pub f0: [f32; 3],
        /// Where the light comes from, octahedral.
        pub incoming: u32,
        /// Of GGX: roughness squared.
        pub alpha: f32,
        /// Fresnel reflectance at a grazing angle, likewise.
        pub f90: f32,
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
    /// Of the beam that each stands for, across it, m^2; 0 of those that reflect nothing. How large a disk it shines as ([`Emitters::Disks`](crate::config::Emitters)).
    pub areas: Buffer,
    /// Glossy VPLs at the same places, [`Lobe`]s; there where they are wanted.
    pub lobes: Option<Buffer>,
    /// Whether the diffuse ones shine.
    pub diffuse: bool,
}

/// Fills the slot with the config's sampler.
pub fn sample(g: &mut Graph, rsm: &Rsm, _gbuffer: &GBuffer, config: &VplsConfig) -> Vpls {
    let diffuse = config.reflection != Reflection::Glossy;
    match config.sampler {
        VplSampler::Regular => from_texels(g, ["vpls/regular", "vpls/regular-glossy"], rsm, config.count, diffuse),
        VplSampler::Hammersley => from_texels(g, ["vpls/hammersley", "vpls/hammersley-glossy"], rsm, config.count, diffuse),
        VplSampler::EveryTexel => {
            from_texels(g, ["vpls/every-texel", "vpls/every-texel-glossy"], rsm, rsm.size[0] * rsm.size[1] * rsm.layers, diffuse)
        }
    }
}

/// Texels of each light's map, in the order of a fixed permutation; the pass says which, and whether there are glossy ones beside the diffuse. Counts `vpls/lit`, VPLs that have flux.
fn from_texels(g: &mut Graph, [matte, glossy]: [&'static str; 2], rsm: &Rsm, count: u32, diffuse: bool) -> Vpls {
    let vpls = Vpls {
        count,
        points: g.buffer::<VplPoint>("vpls/points", count),
        intensities: g.buffer::<[f32; 3]>("vpls/intensities", count),
        areas: g.buffer::<f32>("vpls/areas", count),
        lobes: rsm.glossy.map(|_| g.buffer::<Lobe>("vpls/lobes", count)),
        diffuse,
    };
    let lit = g.count("vpls/lit");
    let pass = match (rsm.glossy, vpls.lobes) {
        (Some(texels), Some(lobes)) => {
            g.compute(glossy).reads("rsm_specular", texels.specular).reads("rsm_lobe", texels.lobe).writes("lobes", lobes)
        }
        _ => g.compute(matte),
    };
    pass.reads("lights", rsm.lights)
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
